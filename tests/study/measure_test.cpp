// SPDX-License-Identifier: Apache-2.0
// The columns against closed forms; planted faults must show in them.
#include <gtest/gtest.h>

#include "reflectree/verify/reference.hpp"
#include "toy_peers.hpp"

namespace reflectree::study {
namespace {

const Direction wo = direction_from_angles(0.7f, 0.f);

// Lambert of albedo 0.5 in three channels; the target is the norm.
const double grey = 0.5 * std::sqrt(3.);

StudyCell cell_of(const AnySampler<Spectrum>& sampler, double albedo, std::uint32_t samples = 1U << 17U) {
  StudyOptions o;
  o.samples = samples;
  return measure_cell(sampler, {}, wo, albedo, 1e-7 * albedo, {}, o, 11);
}

TEST(StudyCell, CosineOnLambertHasNoVariance) {
  const StudyCell c = cell_of({"cosine", CosineToy{brdf("lambert:rho=0.5")}}, grey);
  EXPECT_LT(c.target_variance, 1e-10);
  EXPECT_LT(c.sum_variance, 1e-10);
  EXPECT_LT(c.worst_variance, 1e-10);
  EXPECT_EQ(c.dead, 0);
  EXPECT_FALSE(c.biased);
}

// E[(2 cos)^2] - 1 = 4/3 - 1.
TEST(StudyCell, UniformOnLambertHasAThird) {
  const StudyCell c = cell_of({"uniform", UniformToy{brdf("lambert:rho=0.5")}}, grey);
  EXPECT_NEAR(c.target_variance, 1. / 3, 4e-3);
  EXPECT_NEAR(c.sum_variance, 1. / 3, 4e-3);
  EXPECT_NEAR(c.worst_variance, 1. / 3, 4e-3);
  EXPECT_LT(std::abs(c.bias), 2.5 * c.bias_interval);
  EXPECT_FALSE(c.biased);
}

// A channel that only the diffuse part feeds, under a density for a coloured lobe, is worse than the sum.
TEST(StudyCell, TheWorstChannelIsWorseThanTheSum) {
  const StudyCell c =
      cell_of({"cosine", CosineToy{brdf("0.5*lambert:rho=0.8/0.8/0 + 0.5*phong:kd=0,ks=0.9,n=50")}}, 1);
  EXPECT_GT(c.worst_variance, 1.5 * c.sum_variance);
}

TEST(StudyCell, PlantedBiasIsCaught) {
  const StudyCell scaled = cell_of({"cosine", CosineToy{brdf("lambert:rho=0.5"), 1.005f}}, grey);
  EXPECT_TRUE(scaled.biased);
  EXPECT_NEAR(scaled.bias, 0.005, 1e-4);
  const StudyCell lossy = cell_of({"uniform", UniformToy{brdf("lambert:rho=0.5"), 0.05f}}, grey);
  EXPECT_TRUE(lossy.biased);
  EXPECT_NEAR(lossy.dead, 0.05, 4e-3);
  EXPECT_NEAR(lossy.bias, -0.05, 5e-3);
}

// The same cell at once against a cubature of the function: Loew's smooth lobe, whose albedo is not trivial.
TEST(StudyCell, SmoothLobeIsUnbiasedAgainstCubature) {
  const AnyBrdf f = brdf("low_smooth:a=1,b=30,f0=1");
  const auto a = reference_albedo(target_function(f), wo);
  StudyOptions o;
  const StudyCell good = measure_cell({"cosine", CosineToy{f}}, {}, wo, a.value, a.error, {}, o, 3);
  EXPECT_FALSE(good.biased) << good.bias << " +- " << good.bias_interval;
  const StudyCell bad = measure_cell({"cosine", CosineToy{f, 1.2f}}, {}, wo, a.value, a.error, {}, o, 3);
  EXPECT_TRUE(bad.biased) << bad.bias << " +- " << bad.bias_interval;
}

ReferenceDraws exact_draws(const AnyBrdf& f, const StudyOptions& o) {
  const PeerSubject subject{f, {}, {}, nullptr};
  return reference_draws(*find_sampler("exact")->make(subject, {}), wo, {}, o, 17);
}

// E[w^2] = 2 pi int (t cos_i)^2 by cubature: 2^12 samples of their own see a small part of it, draws of exact
// mode the whole.
TEST(StudyCell, WeightsSeldomDrawnAreSeenThroughTheDensity) {
  const AnyBrdf f = brdf("ggx:alpha=0.004");
  StudyOptions o;
  o.samples = 1U << 12U;
  const TargetFunction target = target_function(f);
  const double albedo = reference_albedo(target, wo).value;
  TargetFunction squared = target;  // so that t' cos_i = (t cos_i)^2
  squared.eval = [&](Vec3<double> o3, std::span<const Vec3<double>> wi, std::span<double> t) {
    target.eval(o3, wi, t);
    for (std::size_t i = 0; i < t.size(); ++i) t[i] *= t[i] * wi[i].z;
  };
  const double truth = 2 * pi_v<double> * reference_albedo(squared, wo).value / sqr(albedo) - 1;
  const AnySampler<Spectrum> uniform("uniform", DenseUniformToy{f});
  const StudyCell own = measure_cell(uniform, {}, wo, albedo, 0, {}, o, 3);
  EXPECT_LT(own.target_variance, 0.7 * truth);
  EXPECT_FALSE(own.by_density);
  const ReferenceDraws reference = exact_draws(f, o);
  const StudyCell seen = measure_cell(uniform, {}, wo, albedo, 0, {}, o, 3, &reference);
  EXPECT_TRUE(seen.by_density);
  EXPECT_NEAR(seen.target_variance / truth, 1, 0.05);
  EXPECT_FALSE(seen.biased);  // the interval knows how little was seen
}

// Uniform directions under the claim of a cosine lobe, which on Lambert would have no variance.
TEST(StudyCell, ADensityThatIsNotDrawnFromDoesNotCount) {
  const AnyBrdf f = brdf("lambert:rho=0.5");
  StudyOptions o;
  o.samples = 1U << 14U;
  const ReferenceDraws reference = exact_draws(f, o);
  const StudyCell honest = measure_cell({"u", DenseUniformToy{f}}, {}, wo, grey, 0, {}, o, 3, &reference);
  EXPECT_TRUE(honest.by_density);
  EXPECT_NEAR(honest.target_variance, 1. / 3, 0.01);
  const StudyCell lying =
      measure_cell({"u", DenseUniformToy{f, true}}, {}, wo, grey, 0, {}, o, 3, &reference);
  EXPECT_FALSE(lying.by_density);
  EXPECT_NEAR(lying.target_variance, 1. / 3, 0.02);
}

// A density a little too small everywhere makes the weight too large, as the paper's does: what it says of
// the variance is not so, for the weight is constant.
TEST(StudyCell, ADensityThatIsNotNormalisedDoesNotCount) {
  const AnyBrdf f = brdf("lambert:rho=0.5");
  StudyOptions o;
  o.samples = 1U << 14U;
  const ReferenceDraws reference = exact_draws(f, o);
  const StudyCell c =
      measure_cell({"c", CosineToy{f, 1.01f, 1 / 1.01f}}, {}, wo, grey, 0, {}, o, 3, &reference);
  EXPECT_FALSE(c.by_density);
  EXPECT_LT(c.target_variance, 1e-9);
  EXPECT_TRUE(measure_cell({"c", CosineToy{f}}, {}, wo, grey, 0, {}, o, 3, &reference).by_density);
}

// Every weight 2 % too large: N times its square enters the error, less the interval of 1e-7.
TEST(StudyCell, BiasEntersTheError) {
  const AnyBrdf f = brdf("lambert:rho=0.5");
  const std::vector<Illumination> lights{procedural_illuminations()[1]};
  StudyOptions o;
  o.samples = 1U << 12U;
  const StudyCell good = measure_cell({"cosine", CosineToy{f}}, {}, wo, grey, 1e-7, lights, o, 3);
  const StudyCell bad = measure_cell({"cosine", CosineToy{f, 1.02f}}, {}, wo, grey, 1e-7, lights, o, 3);
  EXPECT_NEAR(bad.error[0] - sqr(1.02) * good.error[0], 1024 * sqr(0.02), 1e-3);
}

Host many_chunks() {
  Host host;
  host.parallel_for = [](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    for (std::size_t i = n; i-- > 0;) body(i, i + 1);
  };
  return host;
}

// Peers would tabulate it for one azimuth.
TEST(Measure, RefusesAFunctionThatIsNotAsIsotropicAsItSays) {
  const AnyBrdf f = [](Direction viewer, Direction) { return 0.3f + 0.2f * viewer.x; };
  ASSERT_TRUE(f.traits().isotropic) << "by default";
  std::vector<const SamplerInfo*> cosine{find_sampler("cosine")};
  StudyOptions o;
  o.samples = 256, o.theta_o_deg = {40}, o.round_seconds = 1e-5, o.curve_samples = 16, o.curve_repeats = 4;
  try {
    measure({"tilted", {}, f}, cosine, {}, o, {});
    ADD_FAILURE() << "it was measured";
  } catch (const Error& error) {
    EXPECT_NE(error.wrong().find("depends on the azimuth"), std::string::npos) << error.what();
  }
}

// Everything but the timings is the same however the work is cut up.
TEST(Measure, DoesNotDependOnTheHost) {
  const StudyMaterial m{"ggx:alpha=0.4", parse_material("ggx:alpha=0.4"), brdf("ggx:alpha=0.4")};
  std::vector<const SamplerInfo*> ours{find_sampler("exact"), find_sampler("one-shot")};
  StudyOptions o;
  o.samples = 1024, o.theta_o_deg = {10, 60}, o.round_seconds = 1e-5, o.curve_samples = 16,
  o.curve_repeats = 4;
  const std::vector<Illumination> lights = procedural_illuminations();
  const MaterialResult a = measure(m, ours, lights, o, {}), b = measure(m, ours, lights, o, many_chunks());
  ASSERT_EQ(a.samplers.size(), 2U);
  EXPECT_EQ(a.albedo, b.albedo);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(a.samplers[s].bytes, b.samplers[s].bytes);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(a.samplers[s].cells[i].error, b.samplers[s].cells[i].error);
      EXPECT_EQ(a.samplers[s].cells[i].target_variance, b.samplers[s].cells[i].target_variance);
      EXPECT_FALSE(a.samplers[s].cells[i].biased);
      EXPECT_GT(a.samplers[s].cells[i].sample_ns, 0);
    }
    EXPECT_EQ(a.samplers[s].curves[1].random, b.samplers[s].curves[1].random);
    EXPECT_EQ(a.samplers[s].curves[1].stratified, b.samplers[s].curves[1].stratified);
  }
}

}  // namespace
}  // namespace reflectree::study
