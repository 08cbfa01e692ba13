// SPDX-License-Identifier: Apache-2.0
// The one formula of each model serves intervals as it stands: instantiated on a small interval type (without
// outward rounding, which is the business of the real one), it encloses the values at points of the box.
#include <gtest/gtest.h>

#include "random_models.hpp"

namespace reflectree {
namespace {

struct Interval {
  double lo = 0, hi = 0;
  constexpr Interval() = default;
  constexpr explicit Interval(long double x) : lo(double(x)), hi(double(x)) {}
  constexpr Interval(double a, double b) : lo(a), hi(b) {}
};
Interval hull(double a, double b, double c, double d) {
  return {std::min({a, b, c, d}), std::max({a, b, c, d})};
}
Interval operator+(Interval a, Interval b) { return {a.lo + b.lo, a.hi + b.hi}; }
Interval operator-(Interval a) { return {-a.hi, -a.lo}; }
Interval operator-(Interval a, Interval b) { return a + -b; }
Interval operator*(Interval a, Interval b) {
  return hull(a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi);
}
Interval operator/(Interval a, Interval b) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (b.lo <= 0 && b.hi >= 0) return {-infinity, infinity};
  return hull(a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi);
}
Interval min(Interval a, Interval b) { return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)}; }
Interval max(Interval a, Interval b) { return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)}; }
Interval exp(Interval a) { return {std::exp(a.lo), std::exp(a.hi)}; }
Interval sqrt(Interval a) { return {std::sqrt(std::max(a.lo, 0.0)), std::sqrt(a.hi)}; }
Interval log1p(Interval a) { return {std::log1p(std::max(a.lo, -1.0)), std::log1p(a.hi)}; }

bool encloses(Interval box, double x) {
  return box.lo <= x + 1e-9 * std::abs(x) && x - 1e-9 * std::abs(x) <= box.hi;
}

Interval around(double x, double radius) { return {x - radius, x + radius}; }
Vec3<Interval> around(Vec3<double> v, double radius) {
  return {around(v.x, radius), around(v.y, radius), around(v.z, radius)};
}
ShadingGeometry<Interval> around(const ShadingGeometry<double>& g, double radius) {
  return {around(g.wo, radius),          around(g.wi, radius),          around(g.wh, radius),
          around(g.cos_theta_o, radius), around(g.cos_theta_i, radius), around(g.cos_theta_h, radius),
          around(g.cos_theta_d, radius)};
}

template <class M>
class IntervalInstantiation : public testing::Test {};
TYPED_TEST_SUITE(IntervalInstantiation, AllModels::as<testing::Types>);

TYPED_TEST(IntervalInstantiation, EnclosesTheValuesInTheBox) {
  Pcg32 bits(1);
  int tight = 0, boxes = 0;
  const TypeParam model;
  for (int i = 0; i < 300; ++i) {
    const Direction o = random_direction(bits), w = random_direction(bits);
    const Vec3<double> wo{o.x, o.y, o.z}, wi{w.x, w.y, w.z};
    const double radius = 1e-4;
    const Interval bound = model(around(shading_geometry(wo, wi), radius)).r;
    for (int k = 0; k < 4; ++k) {
      const auto jitter = [&] { return radius / 8 * (2 * uniform(bits) - 1); };
      const Vec3<double> near{wi.x + jitter(), wi.y + jitter(), wi.z + jitter()};
      const ShadingGeometry<double> g = shading_geometry(wo, near);
      if (std::abs(g.cos_theta_h - shading_geometry(wo, wi).cos_theta_h) > radius) continue;
      EXPECT_TRUE(encloses(bound, model(g).r)) << bound.lo << " " << bound.hi << " misses " << model(g).r;
    }
    ++boxes;
    tight += bound.hi < 2 * model(shading_geometry(wo, wi)).r + 1e-3;
  }
  EXPECT_GT(tight, boxes / 2);  // an enclosure of everything would prove nothing
}

}  // namespace
}  // namespace reflectree
