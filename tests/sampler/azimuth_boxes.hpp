// SPDX-License-Identifier: Apache-2.0
// Random boxes of viewers of any azimuth, of places in the square of a domain in the frame of the surface, and of a
// width; and what forms say about points of them.
#pragma once

#include "../brdf/random_models.hpp"
#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/sampler/square/enclosed_map.hpp"

namespace reflectree::azimuth_boxes {

inline constexpr DomainKind kinds[] = {DomainKind::slope_star, DomainKind::scaled_star,
                                       DomainKind::projected_disk, DomainKind::equal_area,
                                       DomainKind::stretched};

// theta_o, the coordinates of the square, phi_o, a width.
using Point = std::array<double, 5>;
struct Box {
  Point lo, hi;
  AffineForm variable(std::size_t k) const { return AffineForm::variable(k, lo[k], hi[k]); }
};

inline Box random_box(Pcg32& bits, double largest) {
  constexpr double lo[] = {0, -1, -1, 0, 0.05}, hi[] = {1.5707, 1, 1, 6.2831, 0.8};
  const double share = largest * std::pow(2., -9 * to_unit_double(bits()));
  Box box;
  for (std::size_t k = 0; k < 5; ++k) {
    // Often at a border: the normal, grazing, the rim; or in the middle: the pole, and across phi = pi.
    const double u = to_unit_double(bits());
    const double where = u < 0.1 ? 0 : u < 0.2 ? 1 : u < 0.3 ? 0.5 : to_unit_double(bits());
    const double width = share * (hi[k] - lo[k]);
    volatile float from = float(lo[k] + where * (hi[k] - lo[k] - width));
    box.lo[k] = double(from);
    volatile float to = float(box.lo[k] + width);
    box.hi[k] = double(to);
  }
  return box;
}

inline Domain domain_at(int i) {
  Domain domain{kinds[std::size_t(i) % std::size(kinds)], Symmetry::none, 1.5f};
  domain.stretch = 2.3f, domain.scale_x = 0.2f, domain.scale_y = 0.6f;
  return domain;
}

inline DomainPointT<AffineForm> lifted_box(const Domain& domain, const Box& box) {
  const AffineForm theta = box.variable(0), phi = box.variable(3);
  AffineForm c = widened(cos(theta), length_tolerance);
  const AffineForm s = widened(sin(theta), length_tolerance);
  c.range.hi = std::min(c.range.hi, 1.);
  return lift_box(domain, Vec3<AffineForm>{s * cos(phi), s * sin(phi), c},
                  {box.variable(1), box.variable(2)});
}
inline DomainPoint lifted(const Domain& domain, const Point& at) {
  const double s = std::sin(at[0]);
  return lift(domain, {float(s * std::cos(at[3])), float(s * std::sin(at[3])), float(std::cos(at[0]))},
              {float(at[1]), float(at[2])});
}

inline bool holds(const AffineForm& form, const Box& box, const Point& at, double value) {
  if (!form.range.contains(value)) return false;
  if (form.error == detail::infinity) return true;
  double line = form.middle, error = form.error;
  for (std::size_t k = 5; k < AffineForm::variables; ++k) error += std::abs(form.slope[k]);  // of steps
  for (std::size_t k = 0; k < 5; ++k)
    line += form.slope[k] * (at[k] - 0.5 * (box.lo[k] + box.hi[k])) / (0.5 * (box.hi[k] - box.lo[k]));
  return std::abs(value - line) <= error * (1 + 1e-9);
}

struct Seen {
  int boxes = 0, missed = 0, finite = 0;
};
// enclose(box, geometry) and value(point, geometry): of the green channel; none where the point is not of the box.
template <class Enclose, class Value>
Seen compare(const Enclose& enclose, const Value& value, int boxes, double largest = 0.25) {
  Seen seen;
  Pcg32 bits(23);
  for (int i = 0; i < boxes; ++i) {
    const Domain domain = domain_at(i);
    const Box box = random_box(bits, largest);
    const DomainPointT<AffineForm> lift = lifted_box(domain, box);
    const AffineForm form = enclose(box, lift.geometry) * lift.projected_area;
    ++seen.boxes, seen.finite += form.error < detail::infinity;
    for (int k = 0; k < 6; ++k) {
      Point at;
      for (std::size_t a = 0; a < 5; ++a) {
        const double share = k < 4 ? to_unit_double(bits()) : double(bits() & 1U);
        volatile float place = float(box.lo[a] + share * (box.hi[a] - box.lo[a]));
        at[a] = std::clamp(double(place), box.lo[a], box.hi[a]);
      }
      const DomainPoint point = lifted(domain, at);
      const std::optional<float> f = value(at, point.geometry);
      seen.missed += f && !holds(form, box, at, double(*f * point.projected_area));
    }
  }
  return seen;
}

}  // namespace reflectree::azimuth_boxes
