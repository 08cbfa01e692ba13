// SPDX-License-Identifier: Apache-2.0
// When there is no sample, and how it is told.
#include <gtest/gtest.h>

#include <cmath>

#include "functions.hpp"

namespace reflectree {
namespace {

template <class S>
void expect_no_sample(const S& s, Direction wo) {
  Pcg32 u(1);
  EXPECT_FALSE(s.exact.sample(wo, u));
  EXPECT_FALSE(s.exact.sample_once(wo, u));
  EXPECT_FALSE(s.one_shot.sample(wo, u));
  EXPECT_FALSE(s.one_shot.sample(wo, 0.5, 0.5));
  EXPECT_FALSE(s.one_shot.invert(wo, {0, 0, 1}));
  std::vector<DirectionSample<typename decltype(s.exact)::Value>> out(4);
  EXPECT_EQ(s.exact.sample_n(wo, u, std::span(out)), 0u);
  EXPECT_EQ(s.one_shot.sample_n(wo, u, std::span(out)), 0u);
  EXPECT_EQ(s.exact.pdf(wo, {0, 0, 1}), 0);
  EXPECT_EQ(s.exact.pdf_disk(wo, {0, 0, 1}), 0);
  EXPECT_EQ(s.one_shot.pdf(wo, {0, 0, 1}), 0);
  EXPECT_EQ(s.exact.albedo(wo), 0);
  EXPECT_EQ(s.exact.expected_trials(wo), 0);
}

TEST(Incidence, BelowTheHorizonNotFiniteOrNotUnitIsNoSample) {
  const auto s = make_sampler(material("lambert"));
  const float nan = std::nanf(""), inf = INFINITY;
  for (const Direction wo :
       {Direction{0, 0, -1}, Direction{0.6f, 0, -0.8f}, Direction{1, 0, 0}, Direction{1, 0, -0.f},
        Direction{1, 0, 1e-6f}, Direction{nan, 0, 0.5f}, Direction{0, nan, 0.5f}, Direction{0, 0, nan},
        Direction{inf, 0, 0.5f}, Direction{0, -inf, 0.5f}, Direction{0, 0, inf}, Direction{nan, nan, nan},
        Direction{0, 0, 2}, Direction{3, 0, 0.5f}, Direction{0, 1.5f, 0.5f}}) {
    SCOPED_TRACE(testing::Message() << wo.x << ' ' << wo.y << ' ' << wo.z);
    expect_no_sample(s, wo);
  }
}

TEST(Incidence, TheLastServedDirectionsAreSampled) {
  const auto s = make_sampler(material("plastic:alpha=0.2"));
  Pcg32 u(1);
  for (const double theta : {0., 1e-4, 89.9, 89.99, 89.999}) {
    for (const double phi : {0., 1., -2., 3.1415926}) {
      const auto e = s.exact.sample(wo_at(theta, phi), u), o = s.one_shot.sample(wo_at(theta, phi), u);
      ASSERT_TRUE(e && o) << theta;
      for (const auto& d : {*e, *o}) {
        EXPECT_GT(d.wi.z, 0);
        EXPECT_TRUE(std::isfinite(d.pdf) && d.pdf > 0);
        EXPECT_TRUE(std::isfinite(d.weight[0]));
      }
    }
  }
  // A rounding above one is let pass.
  EXPECT_TRUE(s.exact.sample({0, 0, 1.0000001f}, u));
}

TEST(Incidence, ABlackSurfaceHasNoSample) {
  const auto s = make_sampler([](Direction, Direction) { return 0.f; });
  for (const double theta : {0., 45., 89.}) expect_no_sample(s, wo_at(theta));
}

// Black up to 40 degrees, grey above: no sample, then samples, and never a NaN.
TEST(Incidence, AlbedoZeroForSomeDirectionsOnly) {
  const auto s = make_sampler([](Direction wo, Direction) { return 0.3f * max(0.766f - wo.z, 0.f); });
  expect_no_sample(s, wo_at(0));
  expect_no_sample(s, wo_at(30));
  Pcg32 u(2);
  for (const double theta : {41., 45., 60., 89.}) {
    for (int i = 0; i < 1000; ++i) {
      const auto e = s.exact.sample(wo_at(theta), u), o = s.one_shot.sample(wo_at(theta), u);
      ASSERT_TRUE(e && o) << theta;
      EXPECT_TRUE(std::isfinite(e->weight) && std::isfinite(o->weight));
    }
  }
}

// Anisotropic: one-shot mode is spared the albedo where it is 0 for no viewer, and there alone.
float facing(Direction wo, Direction) { return 0.3f * (1.2f + wo.y); }
using Facing = float (*)(Direction, Direction);
bool is_asked(const OneShotSampler<Facing>& s, Direction wo) {
  Incidence spared, asked;
  EXPECT_TRUE(find_incidence(s.packed().viewer, wo, spared, false));
  EXPECT_TRUE(find_incidence(s.packed().viewer, wo, asked, true));
  EXPECT_NE(asked.albedo, 1);
  return spared.albedo == asked.albedo;
}
int drawn_from_behind(const OneShotSampler<Facing>& s) {
  Pcg32 u(4);
  int drawn = 0;
  for (const double phi : {-1.8, -1.57, -1.2}) drawn += bool(s.sample(wo_at(70, phi), u));
  return drawn;
}
TEST(Incidence, OneShotIsSparedTheAlbedoOnlyWhereItIsNowhereZero) {
  BuildOptions rough;  // built in less time
  rough.albedo_error = 0.01f, rough.expected_trials = 2, rough.one_shot_variance = 0.1f;
  SamplerData data = build(AnyBrdf(facing), rough);
  const auto bright = make_sampler<Facing>(facing, data);
  for (float& a : data.albedo.albedo) a = a < 0.8f ? 0 : a;  // as if it were black from behind
  const auto dark = make_sampler<Facing>(facing, data);
  for (const double phi : {0.3, 1.57, 2.5, -0.1}) {
    EXPECT_FALSE(is_asked(bright.one_shot, wo_at(40, phi)));
    EXPECT_TRUE(is_asked(dark.one_shot, wo_at(40, phi)));
  }
  EXPECT_EQ(drawn_from_behind(bright.one_shot), 3);
  EXPECT_EQ(drawn_from_behind(dark.one_shot), 0);
  // The twin: spared all the same, it draws what reflects nothing.
  PackedSampler wrong = dark.one_shot.packed();
  wrong.viewer.albedo.positive = true;
  EXPECT_EQ(drawn_from_behind({facing, std::make_shared<const PackedSampler>(std::move(wrong))}), 3);
}

// Bounds a thousand times too high: the trials run out, which is counted and told.
TEST(Incidence, TrialsAreCapped) {
  const AnyBrdf f = material("lambert");
  SamplerData data = build(f);
  for (MajorantTree& tree : data.exact) tree.volume *= 1000;
  const auto s = make_sampler(f, data);
  Pcg32 u(3);
  SampleStatistics statistics;
  std::uint64_t none = 0;
  const int n = 2000;
  for (int i = 0; i < n; ++i) none += !s.exact.sample(wo_at(30), u, statistics);
  EXPECT_EQ(statistics.exhausted_count, none);
  EXPECT_EQ(statistics.accepted, n - none);
  EXPECT_EQ(statistics.trials > 256 * none, true);
  const double trials = double(s.exact.expected_trials(wo_at(30)));
  EXPECT_NEAR(double(none) / n, std::pow(1 - 1 / trials, ExactSampler<AnyBrdf>::max_trials), 0.05);
  std::vector<DirectionSample<Spectrum>> out(100'000);
  SampleStatistics batch;
  EXPECT_LT(s.exact.sample_n(wo_at(30), u, std::span(out), batch), out.size());
  EXPECT_EQ(batch.exhausted_count, 1u);
}

}  // namespace
}  // namespace reflectree
