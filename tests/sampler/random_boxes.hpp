// SPDX-License-Identifier: Apache-2.0
// Random boxes of viewers and places in the square of a domain, and what forms say about points of them.
#pragma once

#include "../brdf/random_models.hpp"
#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/sampler/square/enclosed_map.hpp"

namespace reflectree {

inline constexpr DomainKind kinds[] = {
    DomainKind::half_vector,    DomainKind::back_vector, DomainKind::mirror_vector, DomainKind::normal_vector,
    DomainKind::projected_disk, DomainKind::equal_area,  DomainKind::stretched};

// theta_o, then the coordinates of the square.
struct Box {
  std::array<double, 3> lo, hi;
  double at(std::size_t k, double t) const { return lo[k] + t * (hi[k] - lo[k]); }
};

template <class T>
DomainPointT<T> lifted(const Domain& domain, T sine, T cosine, T x, T y) {
  return detail::lift_point(domain, Vec3<T>{sine, T(0), cosine}, Vec2<T>{x, y});
}
inline DomainPointT<AffineForm> lifted_box(const Domain& domain, const Box& box) {
  const AffineForm theta = AffineForm::variable(0, box.lo[0], box.hi[0]);
  AffineForm c = widened(cos(theta), length_tolerance), s = widened(sin(theta), length_tolerance);
  c.range.hi = std::min(c.range.hi, 1.);
  return lift_box(
      domain, {s, AffineForm(0), c},
      {AffineForm::variable(1, box.lo[1], box.hi[1]), AffineForm::variable(2, box.lo[2], box.hi[2])});
}

inline Box random_box(Pcg32& bits) {
  Box box;
  constexpr double lo[] = {0, -1, 0}, hi[] = {1.5707, 1, 1};
  const double share = std::pow(2., -1 - 11 * uniform(bits));
  for (std::size_t k = 0; k < 3; ++k) {
    // Often at a border: the pole, the rim, the normal, grazing.
    const double where = uniform(bits) < 0.2 ? (uniform(bits) < 0.5 ? 0. : 1.) : uniform(bits);
    const double width = share * (hi[k] - lo[k]);
    volatile float from = float(lo[k] + where * (hi[k] - lo[k] - width));  // see affine_form.hpp
    box.lo[k] = double(from);
    volatile float to = float(box.lo[k] + width);
    box.hi[k] = double(to);
  }
  return box;
}

// What a form says about the value at a point of its box.
inline bool holds(const AffineForm& form, const Box& box, const std::array<double, 3>& point, double value) {
  if (!form.range.contains(value)) return false;
  if (form.error == detail::infinity) return true;
  double line = form.middle;
  for (std::size_t k = 0; k < 3; ++k) {
    const double radius = 0.5 * (box.hi[k] - box.lo[k]);
    line += form.slope[k] * (point[k] - 0.5 * (box.lo[k] + box.hi[k])) / radius;
  }
  return std::abs(value - line) <= form.error * (1 + 1e-9);
}

}  // namespace reflectree
