// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "reflectree/math/random.hpp"
#include "reflectree/verify/hemisphere_chart.hpp"
#include "simple_samplers.hpp"

namespace reflectree {
namespace {

Vec3<double> widened(Direction w) { return normalize(Vec3<double>{w.x, w.y, w.z}); }

const Direction centres[] = {direction_at(0), direction_at(30, 77), direction_at(60, -140),
                             direction_at(89.9, 180)};

TEST(HemisphereChart, RoundTrip) {
  for (const Direction centre : centres) {
    const HemisphereChart chart(widened(centre));
    Pcg32 u(1);
    for (int i = 0; i < 20000; ++i) {
      const Vec2<double> p{4 * to_unit_double(u()), 2 * to_unit_double(u())};
      const auto point = chart.direction(p);
      EXPECT_NEAR(length(point.w), 1, 1e-14);
      EXPECT_GE(point.w.z, 0);
      const auto q = chart.coordinates(point.w);
      const auto again = chart.direction(q);
      EXPECT_NEAR(length(again.w - point.w), 0, 1e-13);
      // Where a direction in double holds the digits, the coordinates come back too.
      if (theta_of(point.w) > 0.01) {
        EXPECT_NEAR(q.x, p.x, 1e-6);
      }
      if (std::abs(p.y - 1) > 0.2 && centre.z < 1) {
        EXPECT_NEAR(q.y, p.y, 1e-6);
      }
    }
  }
}

TEST(HemisphereChart, JacobianIsThatOfFiniteDifferences) {
  for (const Direction centre : centres) {
    const HemisphereChart chart(widened(centre));
    Pcg32 u(2);
    for (int i = 0; i < 2000; ++i) {
      const double e = 1e-5;
      const Vec2<double> p{std::floor(4 * to_unit_double(u())) + 0.3 + 0.6 * to_unit_double(u()),
                           std::floor(2 * to_unit_double(u())) + 0.3 + 0.6 * to_unit_double(u())};
      const auto dx = chart.direction({p.x + e, p.y}).w - chart.direction({p.x - e, p.y}).w;
      const auto dy = chart.direction({p.x, p.y + e}).w - chart.direction({p.x, p.y - e}).w;
      const double expected = chart.direction(p).jacobian;
      if (expected < 1e-6) continue;  // differences of unit vectors hold no digits of it
      EXPECT_NEAR(length(cross(dx, dy)) / (4 * e * e) / expected, 1, 1e-4) << p.x << ' ' << p.y;
    }
  }
}

TEST(HemisphereChart, CoversTheHemisphereOnce) {
  for (const Direction centre : centres) {
    const HemisphereChart chart(widened(centre));
    const auto result = cubature(
        [&](std::span<const Vec2<double>> p, std::span<double> out) {
          for (std::size_t i = 0; i < p.size(); ++i) out[i] = chart.direction(p[i]).jacobian;
        },
        HemisphereChart::domain, {1e-8, 0, 1000000, 8, 4});
    EXPECT_NEAR(result.value, 2 * pi_v<double>, 1e-7);
  }
}

}  // namespace
}  // namespace reflectree
