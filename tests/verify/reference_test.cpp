// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/reference.hpp"

#include <gtest/gtest.h>

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/verify/faults.hpp"
#include "simple_samplers.hpp"

namespace reflectree {
namespace {

constexpr double elevations_deg[] = {0, 1e-3, 10, 45, 75, 89, 89.9, 89.999};

TEST(ReferenceAlbedo, OfLambertIsRho) {
  const TargetFunction f = target_function(Lambert{{0.5f, 0.5f, 0.5f}});
  for (const double theta : elevations_deg) {
    const auto a = reference_albedo(f, direction_at(theta, 33));
    EXPECT_TRUE(a.converged);
    EXPECT_NEAR(a.value, 0.5 * std::sqrt(3.), 1e-6) << theta;
  }
}

TEST(ReferenceAlbedo, OfTheLowSmoothLobeIsTheClosedForm) {
  for (const float b : {1.f, 100.f, 1e4f, 1e6f, 1e8f}) {
    const TargetFunction f = target_function(low_smooth(b));
    for (const double theta : elevations_deg) {
      const Direction wo = direction_at(theta, 200);
      const double exact = std::sqrt(1 + 0.25 + 0.0625) * low_smooth_albedo(1, double(b), double(wo.z));
      const auto a = reference_albedo(f, wo);
      // Float directions hold the width of the sharpest lobe, 1e-4, to three digits only, at random.
      EXPECT_NEAR(a.value / exact, 1, 1e-5) << b << ' ' << theta << ' ' << a.error / a.value;
    }
  }
}

// An independent road for the sharpest lobes: over half vectors, in double, with another grading.
double albedo_over_half_vectors(const Ggx& f, double theta_o) {
  const Vec3<double> wo{std::sin(theta_o), 0, std::sin(pi_v<double> / 2 - theta_o)};
  const double largest = std::log1p(1 / 1e-6);
  CubatureOptions options;
  options.relative_tolerance = 1e-7;
  options.cells_x = options.cells_y = 32;
  const auto result = cubature(
      [&](std::span<const Vec2<double>> p, std::span<double> out) {
        for (std::size_t i = 0; i < p.size(); ++i) {
          const double s = 1e-6 * std::expm1(largest * p[i].x);  // sin theta_h
          const double slope = 1e-6 * largest * std::exp(largest * p[i].x);
          const double c = std::sqrt(std::max(1 - s * s, 1e-300));
          const Vec3<double> wh{s * std::cos(p[i].y), s * std::sin(p[i].y), c};
          const double cos_d = dot(wo, wh);
          const Vec3<double> wi = reflect(wo, wh);
          out[i] = 0;
          if (!(cos_d > 0) || !(wi.z > 0)) continue;
          const ShadingGeometry<double> g{wo, wi, wh, wo.z, wi.z, wh.z, cos_d};
          const auto v = f(g);
          out[i] = std::sqrt(v.r * v.r + v.g * v.g + v.b * v.b) * wi.z * 4 * cos_d * s * slope / c;
        }
      },
      {0, 1, 0, pi_v<double>}, options);
  return 2 * result.value;
}

TEST(ReferenceAlbedo, OfSharpGgxAgreesWithTheHalfVectorIntegral) {
  for (const float alpha : {0.002f, 0.01f, 0.1f, 0.5f}) {
    const Ggx ggx{alpha, {0.9f, 0.6f, 0.2f}};
    const TargetFunction f = target_function(ggx);
    for (const double theta : {0., 10., 45., 75., 89., 89.9, 89.999}) {
      const Direction wo = direction_at(theta);
      const double exact = albedo_over_half_vectors(ggx, std::atan2(double(wo.x), double(wo.z)));
      EXPECT_NEAR(reference_albedo(f, wo).value / exact, 1, 1e-5) << alpha << ' ' << theta;
    }
  }
}

// A lobe about the mirror image of a mirror direction, that is about wo itself, has the same albedo.
TEST(ReferenceAlbedo, SeesRetroReflection) {
  const Ggx ggx{0.01f, {0.9f, 0.6f, 0.2f}};
  const auto retro = [ggx](Direction wo, Direction wi) {
    return ggx(shading_geometry(wo, Direction{-wi.x, -wi.y, wi.z}));
  };
  for (const double theta : {0., 45., 75., 85.}) {
    const Direction wo = direction_at(theta);
    const double expected = reference_albedo(target_function(ggx), wo).value;
    EXPECT_NEAR(reference_albedo(target_function(retro), wo).value / expected, 1, 2e-5) << theta;
  }
}

// A Gaussian needle of width 0.003 outside the plane of wo, that a chart about the mirror direction cannot
// resolve; its integral is that of the Gaussian in the tangent plane.
TEST(ReferenceAlbedo, FindsANeedleOutOfThePlane) {
  const Direction axis = direction_at(50, 71);
  const float k = 1 / (2 * 0.003f * 0.003f);
  const auto needle = [=](Direction, Direction wi) {
    const Direction d = wi - axis;
    return std::exp(-k * dot(d, d)) / wi.z;
  };
  for (const bool concurrent : {true, false}) {  // two ways to climb
    TargetFunction f = target_function(needle);
    f.concurrent = concurrent;
    for (const double theta : {0., 20., 80.}) {
      const auto a = reference_albedo(f, direction_at(theta));
      EXPECT_NEAR(a.value, 2 * pi_v<double> * 0.003 * 0.003, 1e-4 * a.value) << theta;
    }
  }
}

TEST(ReferenceAlbedo, HalfIsEnoughForMirrorSymmetry) {
  const TargetFunction f = target_function(Ggx{0.1f, {0.9f, 0.6f, 0.2f}});
  ReferenceOptions half;
  half.mirror_symmetric = true;
  const Direction wo = direction_at(60, 10);
  EXPECT_NEAR(reference_albedo(f, wo, half).value / reference_albedo(f, wo).value, 1, 1e-6);
}

TEST(ReferenceAlbedo, IsZeroBelowTheHorizon) {
  const auto a = reference_albedo(target_function(Lambert{}), direction_at(120));
  EXPECT_EQ(a.value, 0);
}

// The planted twin: a function two per cent off is seen.
TEST(ReferenceAlbedo, SeesAWrongLobe) {
  const double exact = std::sqrt(1 + 0.25 + 0.0625) * low_smooth_albedo(1, 100, 1);
  const auto a = reference_albedo(target_function(low_smooth(102)), direction_at(0));
  EXPECT_GT(std::abs(a.value / exact - 1), 1e-3);
}

}  // namespace
}  // namespace reflectree
