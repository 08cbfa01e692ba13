// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/square/domain_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "functions.hpp"

namespace reflectree {
namespace {

constexpr double elevations_deg[] = {0, 0.01, 15, 45, 70, 85, 89, 89.9, 89.999};

std::vector<Domain> domains(Symmetry symmetry) {
  return {{DomainKind::projected_disk, symmetry, 0},
          {DomainKind::equal_area, symmetry, 0},
          {DomainKind::half_vector, symmetry, 0},
          {DomainKind::back_vector, symmetry, 0},
          {DomainKind::stretched, symmetry, 1.5f},
          {DomainKind::mirror_vector, symmetry, 0},
          {DomainKind::normal_vector, symmetry, 0},
          {DomainKind::stretched, symmetry, 1.1f},
          {DomainKind::scaled_star, symmetry, 0, 1, 0.1f, 0.1f},
          {DomainKind::scaled_star, symmetry, 0, 1, 0.07f, 0.4f}};
}
std::string label(const Domain& d, double theta) {
  return std::string(name_of(d.kind)) + (d.half() ? " half" : "") + " theta_o " + std::to_string(theta);
}

TEST(DomainMap, LiftsToUnitDirectionsAboveTheHorizon) {
  Pcg32 u(1);
  for (const Symmetry symmetry : {Symmetry::none, Symmetry::mirror}) {
    const bool half = symmetry == Symmetry::mirror;
    for (const Domain& d : domains(symmetry)) {
      for (const double theta : elevations_deg) {
        const auto check = [&](float x, float y) {
          const DomainPoint p = lift(d, wo_at(theta), {x, y});
          const ShadingGeometry<float>& g = p.geometry;
          EXPECT_NEAR(dot(g.wi, g.wi), 1, 3e-6) << label(d, theta);
          EXPECT_NEAR(dot(g.wh, g.wh), 1, 3e-6) << label(d, theta);
          EXPECT_GT(g.wi.z, 0) << label(d, theta);
          EXPECT_GT(p.projected_area, 0) << label(d, theta);
          EXPECT_EQ(g.wi.z, g.cos_theta_i);
          if (half) {
            EXPECT_GE(g.wi.y, 0) << label(d, theta);
          }
        };
        for (int i = 0; i < 2000; ++i) {
          const float y = to_unit_float(u());
          check(2 * to_unit_float(u()) - 1, half ? y : 2 * y - 1);
        }
        for (const float x : {-1.f, -0.5f, 0.f, 0.5f, 1.f}) {
          for (const float y : {half ? 0.f : -1.f, 0.f, 0.5f, 1.f}) check(x, y);
        }
      }
    }
  }
}

// The directions agree everywhere; the points wherever float directions tell them apart.
TEST(DomainMap, LowerInvertsLift) {
  Pcg32 u(2);
  for (const Domain& d : domains(Symmetry::none)) {
    for (const double theta : elevations_deg) {
      const Direction wo = wo_at(theta);
      int far_directions = 0, far_points = 0;
      const int n = 1000;
      for (int i = 0; i < n; ++i) {
        const Vec2<float> p{1.96f * to_unit_float(u()) - 0.98f, 1.96f * to_unit_float(u()) - 0.98f};
        const DomainPoint q = lift(d, wo, p);
        const Vec2<float> r = lower(d, wo, q.geometry.wi);
        far_directions += !(length(lift(d, wo, r).geometry.wi - q.geometry.wi) < 2e-5f);
        far_points += !(abs(r.x - p.x) < 5e-4f && abs(r.y - p.y) < 5e-4f);
      }
      EXPECT_EQ(far_directions, 0) << label(d, theta);
      if (theta < 88) {
        EXPECT_LE(far_points, n / 100) << label(d, theta);
      }
    }
  }
}

// projected_area = cos_i |dwi/dx x dwi/dy| * area of the square, by central differences.
TEST(DomainMap, ProjectedAreaIsTheJacobian) {
  Pcg32 u(3);
  for (const Domain& d : domains(Symmetry::none)) {
    for (const double theta : {0., 30., 60., 80.}) {
      int exceptions = 0;
      const int n = 500;
      for (int i = 0; i < n; ++i) {
        const float x = 1.9f * to_unit_float(u()) - 0.95f, y = 1.9f * to_unit_float(u()) - 0.95f, h = 2e-3f;
        const auto wi = [&](float px, float py) { return lift(d, wo_at(theta), {px, py}).geometry.wi; };
        const DomainPoint q = lift(d, wo_at(theta), {x, y});
        const Direction dx = (1 / (2 * h)) * (wi(x + h, y) - wi(x - h, y));
        const Direction dy = (1 / (2 * h)) * (wi(x, y + h) - wi(x, y - h));
        const float area = 4 * q.geometry.cos_theta_i * length(cross(dx, dy));
        // The diagonals of the square are kinks of the concentric map.
        const bool kink = abs(abs(x) - abs(y)) < 2 * h || max(abs(x), abs(y)) < 5 * h;
        exceptions += !kink && !(abs(area - q.projected_area) < 0.01f * q.projected_area + 1e-4f);
      }
      EXPECT_LE(exceptions, n / 50) << label(d, theta);
    }
  }
}

// The projected solid angle of the hemisphere is pi, whatever the map.
TEST(DomainMap, ProjectedAreaIntegratesToPi) {
  for (const Symmetry symmetry : {Symmetry::none, Symmetry::mirror}) {
    const bool half = symmetry == Symmetry::mirror;
    for (const Domain& d : domains(symmetry)) {
      for (const double theta : elevations_deg) {
        double sum = 0;
        const int n = 1000;
        for (int j = 0; j < n; ++j) {
          for (int i = 0; i < n; ++i) {
            const float x = (float(i) + 0.5f) / n, y = (float(j) + 0.5f) / n;
            sum += double(lift(d, wo_at(theta), {2 * x - 1, half ? y : 2 * y - 1}).projected_area);
          }
        }
        EXPECT_NEAR(sum / (n * n) / pi_v<double>, 1, 3e-3) << label(d, theta);
      }
    }
  }
}

// A specular lobe stays put: the half vector of a point near the centre hardly depends on wo.
TEST(DomainMap, HalfVectorKeepsLobesInPlace) {
  const Domain d{DomainKind::half_vector, Symmetry::none, 0};
  for (const Vec2<float> p : {Vec2<float>{0.02f, 0.01f}, Vec2<float>{-0.03f, 0.02f}}) {
    const Direction wh = lift(d, wo_at(0), p).geometry.wh;
    for (const double theta : {30., 60., 80.}) {
      const Direction moved = lift(d, wo_at(theta), p).geometry.wh;
      EXPECT_LT(length(moved - wh), 0.1f * length(Direction{wh.x, wh.y, 0})) << theta;
    }
  }
  // And the mirror direction is its centre, as wo is of the back vector's.
  for (const double theta : {10., 60., 89.}) {
    const Direction wo = wo_at(theta);
    EXPECT_LT(length(lift(d, wo, {}).geometry.wi - Direction{-wo.x, 0, wo.z}), 1e-5f);
    EXPECT_LT(length(lift({DomainKind::back_vector, Symmetry::none, 0}, wo, {}).geometry.wi - wo), 1e-5f);
  }
}

}  // namespace
}  // namespace reflectree
