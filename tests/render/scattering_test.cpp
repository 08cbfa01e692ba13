// SPDX-License-Identifier: Apache-2.0
// Each material's three faces agree: the mean weight of its samples is the integral of f cos, and its density
// integrates to the share of samples that are drawn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reflectree/render/materials/scattering.hpp"

namespace reflectree::render {
namespace {

const Texture white{{1, 1, 1}, nullptr}, red{{.6f, .1f, .1f}, nullptr};
const Rgb eta{.2f, .9f, 1.1f}, k{3.9f, 2.4f, 2.2f};

struct Integrals {
  double f_cos = 0, pdf = 0;
};

// The midpoint rule, in squares of theta and azimuth.
Integrals integrate(const Scattering& s, Direction wo) {
  Integrals sum;
  constexpr int n = 600;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      const double theta = M_PI / 2 * (i + .5) / n, phi = M_PI * (j + .5) / n;
      const Direction wi = direction_from_angles(float(theta), float(phi));
      const double cell = std::sin(theta) * M_PI / 2 / n * M_PI / n;
      sum.f_cos += cell * double(s.f_cos(wo, wi, {}).r), sum.pdf += cell * double(s.pdf(wo, wi, {}));
    }
  }
  return sum;
}

TEST(Scattering, SamplesDensitiesAndValuesAgree) {
  using Kind = Roughness::Kind;
  const std::pair<const char*, ScatteringPtr> all[] = {
      {"diffuse", diffuse(red)},
      {"ggx", rough_conductor({Kind::ggx, .3f, true}, eta, k, white)},
      {"beckmann", rough_conductor({Kind::beckmann, .3f, true}, eta, k, white)},
      {"ggx normals", rough_conductor({Kind::ggx, .3f, false}, eta, k, white)},
      {"beckmann normals", rough_conductor({Kind::beckmann, .2f, false}, eta, k, white)},
      {"ggx of two widths", rough_conductor({Kind::ggx, {.15f, .5f}, true}, eta, k, white)},
      {"beckmann of two widths", rough_conductor({Kind::beckmann, {.5f, .2f}, true}, eta, k, white)},
      {"normals of two widths", rough_conductor({Kind::ggx, {.2f, .5f}, false}, eta, k, white)},
      {"beckmann normals of two widths", rough_conductor({Kind::beckmann, {.2f, .4f}, false}, eta, k, white)},
      {"rough plastic", rough_plastic({.diffuse = red}, {Kind::beckmann, .2f, true})},
      {"blend", blend({{.35f, .35f, .35f}, nullptr}, diffuse(red),
                      rough_conductor({Kind::ggx, .2f, true}, eta, k, white))},
      {"two-sided", two_sided(diffuse(red), diffuse(white))},
  };
  for (const auto& [name, material] : all) {
    for (const float theta : {.2f, 1.f, 1.4f}) {
      const Direction wo = direction_from_angles(theta, .7f);
      const Integrals exact = integrate(*material, wo);
      double sum = 0, squares = 0, drawn = 0;
      PathBits u(Pcg32(7));
      constexpr int n = 200000;
      for (int i = 0; i < n; ++i) {
        const auto s = material->sample(wo, {}, u);
        if (!s) continue;
        ASSERT_FALSE(s->delta);
        ASSERT_NEAR(s->pdf, material->pdf(wo, s->wi, {}), 1e-3f * s->pdf) << name;
        sum += double(s->weight.r), squares += double(s->weight.r) * double(s->weight.r), drawn += 1;
      }
      const double mean = sum / n, error = std::sqrt(std::max(0., squares / n - mean * mean) / n);
      const double slack = 4.5 * error + 3e-4 * exact.f_cos;
      EXPECT_NEAR(mean, exact.f_cos, slack) << name << " at " << theta;
      EXPECT_GT(std::abs(1.03 * mean - exact.f_cos), slack) << name << ": a planted bias of 3 %";
      EXPECT_NEAR(drawn / n, exact.pdf, .006) << name << " at " << theta;
    }
  }
}

TEST(Scattering, GlassAndMirrorsKeepEnergy) {
  PathBits u(Pcg32(3));
  const auto energy_of = [&](const Scattering& glass, float z) {
    const Direction wo{std::sqrt(1 - z * z), 0, z};
    double energy = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      const auto s = glass.sample(wo, {}, u);
      EXPECT_TRUE(s && s->delta);
      EXPECT_NEAR(length(s->wi), 1, 1e-5f);
      // Radiance is scaled by eta^2 where it crosses; power is not.
      const float crossed = z > 0 ? 1.5f : 1 / 1.5f;
      energy += double(s->weight.r) * (s->wi.z * z > 0 ? 1 : double(crossed * crossed)) / n;
    }
    return energy;
  };
  const auto glass = dielectric(1.5f, white, white), other = dielectric(1.501f, white, white);
  for (const float z : {.9f, .3f, -.9f, -.3f}) EXPECT_NEAR(energy_of(*glass, z), 1, 1e-5) << z;
  EXPECT_GT(std::abs(energy_of(*other, .9f) - 1), 1e-4) << "the twin, squeezed by another index";
  const auto mirror = conductor({}, {}, white)->sample({.6f, 0, .8f}, {}, u);
  EXPECT_EQ(mirror->wi, (Direction{-.6f, 0, .8f}));
  EXPECT_EQ(mirror->weight, (Rgb{1, 1, 1}));
}

// A plastic's delta and its ground together: under a white sky, what is not reflected enters and leaves.
TEST(Scattering, SmoothPlasticOfWhiteGroundReflectsAll) {
  PathBits u(Pcg32(5));
  const auto reflected = [&](float ground) {
    const auto p = plastic({.eta = 1.5f, .diffuse = {{ground, ground, ground}, nullptr}, .nonlinear = true});
    double sum = 0;
    constexpr int n = 400000;
    for (int i = 0; i < n; ++i) {
      if (const auto s = p->sample({.6f, 0, .8f}, {}, u)) sum += double(s->weight.r) / n;
    }
    return sum;
  };
  EXPECT_NEAR(reflected(1), 1, 4e-3);
  EXPECT_LT(reflected(.99f), 1 - 8e-3) << "the twin";
}

}  // namespace
}  // namespace reflectree::render
