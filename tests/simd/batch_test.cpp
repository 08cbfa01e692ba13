// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "reflectree/brdf/material/registry.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/brdf/models/retro_reflector.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/simd/sample_batch.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/reference.hpp"

namespace reflectree {
namespace {

// Random directions, with some for which there is no sample.
std::vector<Direction> many_wo(std::size_t n, bool with_bad = true) {
  Pcg32 u(5);
  std::vector<Direction> wo(n);
  for (std::size_t i = 0; i < n; ++i) {
    const float z = 0.002f + 0.998f * to_unit_float(u()), phi = 2 * pi * to_unit_float(u());
    const float s = sqrt(1 - z * z);
    wo[i] = {s * cos(phi), s * sin(phi), with_bad && i % 17 == 3 ? -z : z};
  }
  return wo;
}

template <class Value>
float difference(const DirectionSample<Value>& a, const DirectionSample<Value>& b) {
  float worst = length(a.wi - b.wi);
  worst = max(worst, abs(a.pdf - b.pdf) / max(b.pdf, 1e-30f));
  for (int c = 0; c < channels_of(b.weight); ++c) {
    worst = max(worst, abs(channel_value(a.weight, c) - channel_value(b.weight, c)) /
                           max(channel_value(b.weight, c), 1e-30f));
  }
  return worst;
}

// Samples of the batch that are not those of one-by-one calls with the same bits.
template <class Sampler, class Value>
int unlike(const Sampler& sampler, std::span<const Direction> wo, Pcg32 u,
           std::span<const DirectionSample<Value>> batch) {
  int count = 0;
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const auto one = sampler.sample(wo[i], u);
    count += one ? !(difference(batch[i], *one) < 1e-5f)
                 : batch[i].flags != 0 || batch[i].pdf != 0 || channel_value(batch[i].weight, 0) != 0;
  }
  return count;
}
template <class Sampler, class Value>
int unlike(const Sampler& sampler, std::span<const Direction> wo, std::span<const Vec2<double>> points,
           std::span<const DirectionSample<Value>> batch) {
  int count = 0;
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const auto one = sampler.sample(wo[i], points[i].x, points[i].y);
    count += one ? !(difference(batch[i], *one) < 1e-5f) : batch[i].flags != 0;
  }
  return count;
}

template <class F>
void expect_one_shot_like_one_by_one(const Sampler<F>& sampler, const std::string& name) {
  using Sample = DirectionSample<ValueOf<F>>;
  for (const std::size_t n : {1UL, 3UL, 64UL, 333UL}) {
    const std::vector<Direction> wo = many_wo(n);
    std::vector<Sample> out(n);
    Pcg32 u(n), same(n);
    sample_batch(sampler.one_shot, wo, u, std::span(out));
    EXPECT_EQ(unlike(sampler.one_shot, wo, same, std::span<const Sample>(out)), 0) << name;
    if (n > 3) {
      std::rotate(out.begin(), out.begin() + 1, out.end());  // the twin: lanes mixed up by one
      EXPECT_GT(unlike(sampler.one_shot, wo, same, std::span<const Sample>(out)), int(n) / 2) << name;
    }
    std::vector<Vec2<double>> points(n);
    for (auto& p : points) p = {to_unit_double(u()), to_unit_double(u())};
    sample_batch(sampler.one_shot, wo, std::span<const Vec2<double>>(points), std::span(out));
    EXPECT_EQ(unlike(sampler.one_shot, wo, points, std::span<const Sample>(out)), 0) << name;
  }
}

TEST(SampleBatch, OneShotIsThatOfOneByOneCalls) {
  expect_one_shot_like_one_by_one(make_sampler(Ggx{0.1f}), "ggx");
  expect_one_shot_like_one_by_one(make_sampler(Lambert{}), "lambert");
  expect_one_shot_like_one_by_one(make_sampler(RetroReflector{}), "retro_reflector");
  // A plain lambda: one by one inside the block.
  const auto lobe = [](Direction wo, Direction wi) { return 1 + dot(wo, wi) * dot(wo, wi); };
  expect_one_shot_like_one_by_one(make_sampler(lobe), "lambda");
}

// Of the frame alone; the albedo is a table of random numbers.
PackedSampler known_by(ViewerSymmetry symmetry, bool turns) {
  AlbedoTable table{{min_cos_theta_o, 0.1f, 0.5f, 1}, {}, 1e-4f};
  Pcg32 u(3);
  // Two segments of five rows.
  for (const float share : {0.f, 0.125f, 0.25f, 0.375f, 0.5f, 0.5f, 0.625f, 0.75f, 0.875f, 1.f})
    table.phi_o.push_back(share * azimuth_span(symmetry));
  for (std::size_t i = 0; i < table.phi_o.size() * table.cos_theta_o.size(); ++i)
    table.albedo.push_back(0.5f + to_unit_float(u()));
  PackedSampler packed;
  packed.viewer.frame = {symmetry, 0.3f};
  packed.viewer.cos_axis = cos(0.3f), packed.viewer.sin_axis = sin(0.3f);
  packed.viewer.turns = turns;
  packed.viewer.albedo = pack(table);
  return packed;
}

TEST(ViewerStream, FindsTheBitsOfOneViewerAfterAnother) {
  std::vector<Direction> wo = many_wo(333);
  for (const Direction w : {Direction{0, 0, 1}, Direction{0.6f, 0, 0.8f}, Direction{-0.6f, -0.f, 0.8f},
                            Direction{0, -0.6f, 0.8f}, Direction{-0.f, 0.6f, 0.8f}})
    wo.push_back(w);
  wo.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 1}), wo.push_back({0, 0, 2});
  const auto bits = [](const Incidence& in) {
    std::array<std::uint32_t, 8> b{};
    const float field[] = {in.wo.x, in.wo.y, in.wo.z, in.cos_phi, in.sin_phi, in.azimuth, in.side, in.albedo};
    for (std::size_t k = 0; k < 8; ++k) b[k] = std::bit_cast<std::uint32_t>(field[k]);
    b[6] >>= 31U;  // of `side` the sign alone
    return b;
  };
  for (const auto symmetry : {ViewerSymmetry::two_planes, ViewerSymmetry::one_plane,
                              ViewerSymmetry::half_turn, ViewerSymmetry::none}) {
    for (const bool turns : {false, true}) {
      const PackedSampler packed = known_by(symmetry, turns);
      detail::ViewerStream stream(packed, wo, true), shifted(packed, wo, true);
      std::size_t none = 0, mixed_up = 0;
      for (std::size_t i = 0; i < wo.size(); ++i) {
        Incidence one{}, many{}, next{};
        const bool found = find_incidence(packed.viewer, wo[i], one);
        ASSERT_EQ(stream.find(i, many), found) << name_of(symmetry) << ' ' << i;
        none += !found;
        if (!found) continue;
        EXPECT_EQ(bits(many), bits(one)) << name_of(symmetry) << ' ' << turns << ' ' << i;
        shifted.find(std::min(i + 1, wo.size() - 1), next);  // the twin: a lane beside
        mixed_up += bits(next) != bits(one);
      }
      EXPECT_EQ(none, 22U);
      EXPECT_GT(mixed_up, 300U);
    }
  }
}

// A batch as a sampler that draws one direction: every other wo of the batch is a random one, so that lanes
// that were mixed up would show. `shift`: the planted fault.
template <class Sampler>
ErasedSampler drawn_in_batches(const Sampler& sampler, std::size_t shift) {
  using Sample = DirectionSample<typename Sampler::Value>;
  struct State {
    std::vector<Direction> wo = many_wo(334, false);
    std::vector<Sample> out = std::vector<Sample>(334);
    std::size_t next = 334;
  };
  ErasedSampler erased;
  erased.name = "batch";
  erased.concurrent = false;
  erased.sample = [&sampler, shift, state = std::make_shared<State>()](Direction wo, Pcg32& u,
                                                                       DrawnDirection& drawn) {
    if (state->next >= state->out.size()) {
      for (std::size_t i = 0; i < state->wo.size(); i += 2) state->wo[i] = wo;
      sample_batch(sampler, state->wo, u, std::span(state->out));
      state->next = 0;
    }
    const Sample& s = state->out[(state->next + shift) % state->out.size()];
    state->next += 2;
    drawn = {s.wi, s.pdf, sampler.packed().target(s.weight)};
    return s.flags != 0;
  };
  return erased;
}

template <class F>
void expect_distributed_as_t_cos(const F& f, Direction wo) {
  const Sampler<F> sampler = make_sampler(f);
  const Bins bins = equal_mass_bins(target_function(AnyBrdf(f)), wo);
  const ChiSquareOptions options{.samples = 400'000};
  const Tally right = tally_of(drawn_in_batches(sampler.exact, 0), bins, options);
  EXPECT_EQ(right.none, 0U);
  for (const CheckResult& r : {check_counts(right, bins, options), check_weights(right, bins, options),
                               check_mean_weight(right, bins, options)}) {
    EXPECT_TRUE(r.passed) << to_line(r);
  }
  const Tally mixed_up = tally_of(drawn_in_batches(sampler.exact, 1), bins, options);
  EXPECT_FALSE(check_counts(mixed_up, bins, options).passed);
  const Tally one_shot = tally_of(drawn_in_batches(sampler.one_shot, 0), bins, options);
  EXPECT_TRUE(check_weights(one_shot, bins, options).passed);
}

TEST(SampleBatch, ExactIsDistributedAsTheTarget) {
  const auto wo_at = [](float theta) { return Direction{-sin(theta), 0, cos(theta)}; };
  expect_distributed_as_t_cos(Ggx{0.1f}, wo_at(0.5f));
  expect_distributed_as_t_cos(Ggx{0.3f}, wo_at(1.5f));
  expect_distributed_as_t_cos(RetroReflector{}, wo_at(1.f));
}

// One batch: pdf and weight as the sampler's own pdf(); all served; the trials as many as expected.
template <class F>
void expect_exact_like_one_by_one(const Sampler<F>& sampler, const std::string& name) {
  using Sample = DirectionSample<ValueOf<F>>;
  const std::size_t n = 3000;
  const std::vector<Direction> wo = many_wo(n);
  std::vector<Sample> out(n);
  Pcg32 u(3), same(3);
  SampleStatistics statistics;
  sample_batch(sampler.exact, wo, u, std::span(out), statistics);
  int wrong = 0, lost = 0;
  double expected = 0, variance = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (wo[i].z < 0) {
      lost += out[i].flags != 0;
      continue;
    }
    const double trials = double(sampler.exact.expected_trials(wo[i]));
    expected += trials;
    variance += trials * max(trials - 1, 0.);
    lost += out[i].flags != sample_reflection || !(out[i].pdf > 0);
    // float directions: sharp peaks magnify their rounding
    const float pdf = sampler.exact.pdf(wo[i], out[i].wi);
    wrong += !(abs(pdf - out[i].pdf) < 2e-3f * pdf);
    const float f_cos = sampler.exact.packed().target(out[i].weight) * out[i].pdf;
    wrong += !(abs(f_cos - pdf * sampler.exact.albedo(wo[i])) < 2e-3f * f_cos);
  }
  EXPECT_EQ(lost, 0) << name;
  EXPECT_LE(wrong, 6) << name;
  EXPECT_EQ(statistics.exhausted_count, 0U) << name;
  EXPECT_NEAR(double(statistics.trials), expected, 5 * std::sqrt(variance) + 1e-3 * expected + 1) << name;

  std::vector<Sample> again(n);
  sample_batch(sampler.exact, wo, same, std::span(again));
  int different = 0;
  for (std::size_t i = 0; i < n; ++i) different += !(difference(out[i], again[i]) == 0);
  EXPECT_EQ(different, 0) << name << ": the same seed gives the same samples";
}

TEST(SampleBatch, ExactAgreesWithItsOwnPdf) {
  expect_exact_like_one_by_one(make_sampler(Ggx{0.1f}), "ggx");
  BuildOptions by_luminance;
  by_luminance.target.kind = TargetKind::luminance;
  expect_exact_like_one_by_one(make_sampler(Ggx{0.1f}, by_luminance), "ggx by luminance");
  expect_exact_like_one_by_one(make_sampler(Lambert{}), "lambert");
}

TEST(SampleBatch, EveryModelOfTheRegistryByOneErasedCallABlock) {
  for (const ModelInfo& info : models()) {
    std::vector<Rgb> values;
    for (const ParameterInfo& p : info.parameters) values.push_back(p.initial);
    const AnyBrdf f = info.make(values);
    if (!f.traits().isotropic) continue;
    const Sampler<AnyBrdf> sampler = make_sampler(f);
    expect_one_shot_like_one_by_one(sampler, std::string(info.name));
    expect_exact_like_one_by_one(sampler, std::string(info.name));
  }
}

TEST(SampleBatch, NothingIsAskedOfAnEmptyBatch) {
  const Sampler<Lambert> sampler = make_sampler(Lambert{});
  Pcg32 u(1), same(1);
  sample_batch(sampler.exact, {}, u, std::span<DirectionSample<Rgb>>());
  sample_batch(sampler.one_shot, {}, u, std::span<DirectionSample<Rgb>>());
  EXPECT_EQ(u(), same());
}

}  // namespace
}  // namespace reflectree
