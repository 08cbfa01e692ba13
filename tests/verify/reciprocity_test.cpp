// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/reciprocity.hpp"

#include <gtest/gtest.h>

#include "reflectree/brdf/models/ggx.hpp"
#include "simple_samplers.hpp"

namespace reflectree {
namespace {

TEST(Physics, OfGgxIsReciprocalIsotropicAndConservesEnergy) {
  const PhysicsReport report = measure_physics(target_function(Ggx{0.2f, {0.5f, 0.5f, 0.5f}}), 4000);
  EXPECT_LT(report.reciprocity.worst, 1e-4);
  EXPECT_TRUE(check_isotropy(report).passed) << to_line(check_isotropy(report));
  EXPECT_TRUE(check_mirror_symmetry(report).passed) << to_line(check_mirror_symmetry(report));
  EXPECT_LT(report.max_albedo, std::sqrt(3.));
  EXPECT_GT(report.max_albedo, 0.4 * std::sqrt(3.));
}

TEST(Physics, SeesEachViolation) {
  // Not reciprocal, by a known amount: |1 - cos_o / cos_i| has a large mean.
  const auto one_way = [](Direction wo, Direction) { return wo.z; };
  EXPECT_GT(measure_physics(target_function(one_way), 2000).reciprocity.mean, 0.1);
  EXPECT_TRUE(check_isotropy(measure_physics(target_function(one_way), 2000)).passed);

  const auto brushed = [](Direction wo, Direction wi) { return 1 + 0.01f * (wo.x + wi.x); };
  const PhysicsReport a = measure_physics(target_function(brushed), 2000);
  EXPECT_FALSE(check_isotropy(a).passed);

  // Isotropic but handed: the sign of the sine of the azimuth between wo and wi matters.
  const auto handed = [](Direction wo, Direction wi) { return 1 + 0.01f * (wo.x * wi.y - wo.y * wi.x); };
  const PhysicsReport b = measure_physics(target_function(handed), 2000);
  EXPECT_TRUE(check_isotropy(b).passed);
  EXPECT_FALSE(check_mirror_symmetry(b).passed);

  const auto bright = [](Direction wo, Direction) { return 1 / (pi * (0.2f + wo.z)); };
  const PhysicsReport c = measure_physics(target_function(bright), 200);
  EXPECT_NEAR(c.max_albedo, 1 / (0.2 + std::cos(89 * pi_v<double> / 180)), 1e-3);
  EXPECT_NEAR(c.max_albedo_theta_o, 89 * pi_v<double> / 180, 1e-6);
}

}  // namespace
}  // namespace reflectree
