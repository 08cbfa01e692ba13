// SPDX-License-Identifier: Apache-2.0
// The average over rotations in closed form: against lights whose correlation is known, and against
// rotations drawn one by one.
#include "reflectree/study/illumination.hpp"

#include <gtest/gtest.h>

#include "reflectree/error.hpp"
#include "toy_peers.hpp"

namespace reflectree::study {
namespace {

LatLong map_of(int width, int height, double (*radiance)(double theta, double phi)) {
  LatLong map{width, height, {}};
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) {
      map.radiance.push_back(
          float(radiance(pi_v<double> * (r + 0.5) / height, 2 * pi_v<double> * (c + 0.5) / width)));
    }
  }
  return map;
}

// L = 1 + cos theta has <L> = 1, <L^2> = 4/3 and C(g) = 1 + cos(g) / 3.
Illumination linear_light() {
  return make_illumination("linear",
                           map_of(512, 512, [](double theta, double) { return 1 + std::cos(theta); }));
}

TEST(Illumination, LinearLightHasItsClosedForm) {
  const Illumination e = linear_light();
  EXPECT_NEAR(e.mean, 1, 1e-4);
  EXPECT_NEAR(e.mean_square, 4. / 3, 1e-4);
  for (const double cos_g : {1., 0.999, 0.7, 0., -0.5, -1.}) {
    EXPECT_NEAR(e.correlation_at(cos_g), 1 + cos_g / 3, 3e-3) << cos_g;
  }
}

// A disk of radius r: C(0) = <L^2> = share of the sphere, and nothing beyond 2 r.
TEST(Illumination, TheSmallLightReachesNoFurtherThanItself) {
  const Illumination e = procedural_illuminations()[0];
  const double r = 5 * pi_v<double> / 180, share = (1 - std::cos(r)) / 2;
  EXPECT_NEAR(e.mean, share, 2e-3 * share);
  EXPECT_NEAR(e.mean_square, share, 2e-3 * share);
  EXPECT_GT(e.correlation_at(std::cos(1.5 * r)), 0);
  EXPECT_EQ(e.correlation_at(std::cos(2.2 * r)), 0);
  // Overlap of two flat disks at distance r: (2 acos(1/2) - sqrt(3)/2) / pi = 0.391.
  EXPECT_NEAR(e.correlation_at(std::cos(r)) / share, 0.391, 0.01);
}

// Cosine sampling of Lambert under 1 + n.w: a^2 (4/3 - (1 + |E wi|^2 / 3)), |E wi| = 2/3: 5/27.
TEST(Illumination, LambertUnderTheLinearLight) {
  StudyOptions o;
  o.samples = 1U << 16U;
  const std::vector<Illumination> lights{linear_light()};
  const AnySampler<Spectrum> cosine("cosine", CosineToy{brdf("lambert:rho=0.5")});
  const StudyCell c = measure_cell(cosine, {}, {0, 0, 1}, 0.5 * std::sqrt(3.), 0, lights, o, 5);
  EXPECT_NEAR(c.error[0], 5. / 27, 2e-3);
}

// The closed form against explicit rotations, sample by sample, under a wide disk and a sky. A fault of
// 15 % (one of the two terms bent) would be seen.
TEST(Illumination, AgreesWithExplicitRotations) {
  std::vector<Illumination> lights{
      make_illumination("disk", map_of(8, 1024, [](double theta, double) { return theta < 0.6 ? 1. : 0.; })),
      procedural_illuminations()[1]};
  StudyOptions o;
  o.curve_samples = 4, o.curve_repeats = 48'000, o.samples = 1U << 17U, o.mean_of = 0;
  const AnySampler<Spectrum> cosine("cosine", CosineToy{brdf("phong:kd=0.3,ks=0.5,n=20")});
  const Direction wo = direction_from_angles(0.7f, 0.f);
  const StudyCell c = measure_cell(cosine, {}, wo, 1, 0, lights, o, 5);
  const auto curves = measure_curves(cosine, wo, 1, lights, o, 6);
  for (std::size_t e = 0; e < lights.size(); ++e) {
    EXPECT_NEAR(curves[e].random[0] / c.error[e], 1, 0.06) << lights[e].name;
    EXPECT_NEAR(curves[e].random[1] * 4 / c.error[e], 1, 0.06) << lights[e].name;
  }
  for (Illumination& light : lights) {
    for (double& x : light.correlation) x *= 0.7;
  }
  const StudyCell bent = measure_cell(cosine, {}, wo, 1, 0, lights, o, 5);
  EXPECT_GT(bent.error[1] / curves[1].random[0], 1.1);
}

// Lambert under the sky is smooth: Owen-Sobol' points fall faster than 1 / n.
TEST(Illumination, StratifiedPointsFallFaster) {
  const std::vector<Illumination> lights = procedural_illuminations();
  StudyOptions o;
  o.curve_samples = 256, o.curve_repeats = 128;
  const AnySampler<Spectrum> cosine("cosine", CosineToy{brdf("lambert:rho=0.5")});
  const ErrorCurve sky = measure_curves(cosine, {0, 0, 1}, 0.5 * std::sqrt(3.), lights, o, 6)[1];
  EXPECT_NEAR(std::log(sky.random.back() / sky.random[1]) / std::log(64.), -1, 0.12);
  EXPECT_LT(std::log(sky.stratified.back() / sky.stratified[1]) / std::log(64.), -1.3);
}

TEST(Illumination, RefusesBadMaps) {
  EXPECT_THROW(make_illumination("a", {}), Error);
  EXPECT_THROW(make_illumination("a", {1, 1, {-1.f}}), Error);
  EXPECT_THROW(make_illumination("a", {1, 1, {std::nanf("")}}), Error);
  EXPECT_THROW(make_illumination("a", {2, 1, {0.f, 0.f}}), Error);
}

}  // namespace
}  // namespace reflectree::study
