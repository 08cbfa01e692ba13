// SPDX-License-Identifier: Apache-2.0
// The contract of every model's enclosure: over random boxes of viewers and places in the square of any domain
// it holds what the model returns, in float and in double; sharper boxes give sharper bounds. A model joins by
// the line that registers it.
#include <gtest/gtest.h>

#include "../brdf/random_models.hpp"
#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/sampler/square/enclosed_map.hpp"

namespace reflectree {
namespace {

constexpr DomainKind kinds[] = {
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
DomainPointT<AffineForm> lifted_box(const Domain& domain, const Box& box) {
  const AffineForm theta = AffineForm::variable(0, box.lo[0], box.hi[0]);
  AffineForm c = widened(cos(theta), length_tolerance), s = widened(sin(theta), length_tolerance);
  c.range.hi = std::min(c.range.hi, 1.);
  return lifted(domain, s, c, AffineForm::variable(1, box.lo[1], box.hi[1]),
                AffineForm::variable(2, box.lo[2], box.hi[2]));
}

Box random_box(Pcg32& bits) {
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
bool holds(const AffineForm& form, const Box& box, const std::array<double, 3>& point, double value) {
  if (!form.range.contains(value)) return false;
  if (form.error == detail::infinity) return true;
  double line = form.middle;
  for (std::size_t k = 0; k < 3; ++k) {
    const double radius = 0.5 * (box.hi[k] - box.lo[k]);
    line += form.slope[k] * (point[k] - 0.5 * (box.lo[k] + box.hi[k])) / radius;
  }
  return std::abs(value - line) <= form.error * (1 + 1e-9);
}

template <class M>
struct Seen {
  std::size_t boxes = 0, missed = 0, finite = 0;
};

// f: a callable that is held against the enclosure of `model`.
template <class M, class F>
Seen<M> compare(const M& model, const F& f, Pcg32& bits, int boxes) {
  Seen<M> seen;
  for (int i = 0; i < boxes; ++i) {
    const Domain domain{kinds[std::size_t(i) % std::size(kinds)], Symmetry::mirror, 1.5f};
    const Box box = random_box(bits);
    const DomainPointT<AffineForm> lift = lifted_box(domain, box);
    const AffineForm form = model(lift.geometry).g * lift.projected_area;
    ++seen.boxes, seen.finite += form.error < detail::infinity;
    for (int k = 0; k < 6; ++k) {
      std::array<double, 3> at{};
      for (std::size_t a = 0; a < 3; ++a) {
        volatile float place = float(box.at(a, k < 4 ? uniform(bits) : double(bits() & 1U)));
        at[a] = std::clamp(double(place), box.lo[a], box.hi[a]);
      }
      const auto point =
          lifted(domain, float(std::sin(at[0])), float(std::cos(at[0])), float(at[1]), float(at[2]));
      if (!holds(form, box, at, double(f(point.geometry).g * point.projected_area))) ++seen.missed;
    }
  }
  return seen;
}

template <class M>
class ModelEnclosure : public testing::Test {};
TYPED_TEST_SUITE(ModelEnclosure, AllModels::as<testing::Types>);

TYPED_TEST(ModelEnclosure, HoldsItsValues) {
  Pcg32 bits(5);
  std::size_t finite = 0, boxes = 0;
  for (int i = 0; i < 60; ++i) {
    const TypeParam model = i == 0 ? TypeParam() : random_model<TypeParam>(bits);
    const auto seen = compare(model, model, bits, 35);
    EXPECT_EQ(seen.missed, 0U) << model.traits().name;
    finite += seen.finite, boxes += seen.boxes;
  }
  EXPECT_GT(finite, boxes / 2) << "an enclosure of everything would prove nothing";
}

// The twin: a model that differs from the one that was enclosed by two thousandths, in the lobe or all over.
TYPED_TEST(ModelEnclosure, TwinOfAnotherFunctionIsFound) {
  Pcg32 bits(5);
  const TypeParam model;
  const auto brighter = [&](const ShadingGeometry<float>& g) { return 1.002f * model(g); };
  EXPECT_GT(compare(model, brighter, bits, 700).missed, 0U);
}

// To the last bit, where it is isotropic: the proof looks at one side.
TYPED_TEST(ModelEnclosure, IsMirrorSymmetric) {
  Pcg32 bits(8);
  for (int i = 0; i < 2000; ++i) {
    const TypeParam model = i == 0 ? TypeParam() : random_model<TypeParam>(bits);
    if (!model.traits().isotropic_by_formula) continue;
    const Domain domain{kinds[std::size_t(i) % std::size(kinds)], Symmetry::mirror, 1.5f};
    const float theta = float(1.57 * uniform(bits)), x = float(2 * uniform(bits) - 1),
                y = float(uniform(bits));
    const Direction wo{std::sin(theta), 0, std::cos(theta)};
    EXPECT_EQ(model(lift(domain, wo, {x, y}, false).geometry),
              model(lift(domain, wo, {x, y}, true).geometry));
  }
}

TYPED_TEST(ModelEnclosure, SharperBoxesGiveSharperBounds) {
  Pcg32 bits(6);
  const TypeParam model;
  int looked = 0, sharper = 0;
  for (int i = 0; i < 200; ++i) {
    const Domain domain{kinds[std::size_t(i) % std::size(kinds)], Symmetry::mirror, 1.5f};
    const auto radius_of = [&](double share) {
      Box box;
      const std::array<double, 3> centre{0.7, 0.3, 0.4};
      for (std::size_t k = 0; k < 3; ++k) box.lo[k] = centre[k] - share, box.hi[k] = centre[k] + share;
      const DomainPointT<AffineForm> lift = lifted_box(domain, box);
      return (model(lift.geometry).g * lift.projected_area).error;
    };
    const double share = 0.004 * std::pow(0.5, uniform(bits));
    const double wide = radius_of(share), narrow = radius_of(share / 2);
    if (!(wide > 1e-5)) continue;  // the roundings of floats are left
    ++looked, sharper += narrow < 0.6 * wide;
  }
  EXPECT_EQ(sharper, looked);
}

}  // namespace
}  // namespace reflectree
