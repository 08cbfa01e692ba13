// SPDX-License-Identifier: Apache-2.0
// Rounds against what they must equal: batches of one block, one-by-one calls, division among the leaves.
#include "reflectree/simd/sample_rounds.hpp"

#include <gtest/gtest.h>

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/reference.hpp"

namespace reflectree {
namespace {

// Random directions, with some for which there is no sample.
std::vector<Direction> many_wo(std::size_t n) {
  Pcg32 u(5);
  std::vector<Direction> wo(n);
  for (std::size_t i = 0; i < n; ++i) {
    wo[i] = direction_from_angles(1.5f * to_unit_float(u()), 2 * pi * to_unit_float(u()));
    if (i % 17 == 3) wo[i].z = -wo[i].z;
  }
  return wo;
}

struct Arrays {
  std::vector<Direction> wi;
  std::vector<float> pdf, weight;
  std::vector<std::uint8_t> valid;
  // What nobody writes stays wrong.
  Arrays(std::size_t n, int channels)
      : wi(n), pdf(n, -1), weight(n * std::size_t(channels), -1), valid(n, 7) {}
  SampleRows rows() { return {wi, pdf, weight, valid}; }
};

// A function that counts its calls, and the directions that they asked for.
struct Calls {
  std::size_t count = 0, directions = 0;
};
struct Counted {
  std::shared_ptr<Calls> calls;
  Rgb operator()(Direction wo, Direction wi) const { return Ggx{0.2f}(shading_geometry(wo, wi)); }
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<Rgb> out) const {
    ++calls->count, calls->directions += wo.size();
    for (std::size_t i = 0; i < wo.size(); ++i) out[i] = reflectree::eval(*this, wo[i], wi[i]);
  }
};
static_assert(BatchBrdf<Counted>);

// Places where rows and samples differ; "no sample" must be zeros.
int unlike(Arrays& rows, std::size_t first, std::span<const DirectionSample<Spectrum>> samples,
           float tolerance) {
  int count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const DirectionSample<Spectrum>& s = samples[i];
    const std::size_t k = first + i;
    float worst = length(rows.wi[k] - s.wi) + abs(float(rows.valid[k]) - float(s.flags != 0));
    worst = max(worst, abs(rows.pdf[k] - s.pdf) / max(s.pdf, 1e-30f));
    for (int c = 0; c < s.weight.channels(); ++c) {
      const float weight = rows.weight[k * std::size_t(s.weight.channels()) + std::size_t(c)];
      worst = max(worst, abs(weight - s.weight[c]) / max(s.weight[c], 1e-30f));
    }
    count += !(worst <= tolerance);
  }
  return count;
}

const Sampler<AnyBrdf>& gold() {
  static const Sampler<AnyBrdf> sampler = make_sampler(AnyBrdf(Ggx{0.1f, {1, 0.8f, 0.3f}}));
  return sampler;
}

TEST(SampleRounds, ExactRoundsOfOneBlockAreBatches) {
  const std::vector<Direction> wo = many_wo(1000);
  std::vector<DirectionSample<Spectrum>> batch(wo.size());
  Pcg32 u(1), same(1);
  sample_batch(gold().exact, wo, u, std::span(batch));
  Arrays rows(wo.size(), 3);
  sample_rounds(gold().exact, wo, {}, same, rows.rows(), 64);
  EXPECT_EQ(unlike(rows, 0, batch, 0), 0);
  std::rotate(batch.begin(), batch.begin() + 1, batch.end());  // the twin: places mixed up by one
  EXPECT_GT(unlike(rows, 0, batch, 1e-5f), 900);
}

TEST(SampleRounds, OneShotRoundsAreOneByOneCalls) {
  for (const std::size_t n : {1UL, 63UL, 1000UL}) {
    const std::vector<Direction> wo = many_wo(n);
    std::vector<Vec2<double>> points(n);
    Pcg32 u(n), same(n);
    std::vector<DirectionSample<Spectrum>> by_alias(n), by_point(n);
    for (std::size_t i = 0; i < n; ++i) {
      if (const auto s = gold().one_shot.sample(wo[i], u))
        by_alias[i] = *s;
      else
        by_alias[i] = {{}, 0, Spectrum(3), 0};
    }
    for (auto& p : points) p = {to_unit_double(u()), to_unit_double(u())};
    if (n > 5) points[5].y = 1.5;  // no uniform: no sample
    for (std::size_t i = 0; i < n; ++i) {
      if (const auto s = gold().one_shot.sample(wo[i], points[i].x, points[i].y))
        by_point[i] = *s;
      else
        by_point[i] = {{}, 0, Spectrum(3), 0};
    }
    Arrays rows(n, 3);
    sample_rounds(gold().one_shot, wo, {}, same, rows.rows(), 200);
    EXPECT_EQ(unlike(rows, 0, by_alias, 1e-5f), 0) << n;
    Arrays of_points(n, 3);
    sample_rounds(gold().one_shot, wo, points, same, of_points.rows(), 200);
    EXPECT_EQ(unlike(of_points, 0, by_point, 1e-5f), 0) << n;
  }
}

TEST(SampleRounds, ManyOfOneDirectionAreThoseOfTheSampler) {
  const Direction wo = direction_from_angles(0.7f, 2.f);
  for (const std::size_t n : {0UL, 1UL, 777UL}) {
    std::vector<DirectionSample<Spectrum>> exact(n), one_shot(n);
    Pcg32 u(7), same(7);
    EXPECT_EQ(gold().exact.sample_n(wo, u, exact), n);
    EXPECT_EQ(gold().one_shot.sample_n(wo, u, one_shot), n);
    Arrays rows(n, 3), shot(n, 3);
    EXPECT_EQ(sample_n_rounds(gold().exact, wo, same, rows.rows(), 100'000), n);
    EXPECT_EQ(sample_n_rounds(gold().one_shot, wo, same, shot.rows(), 128), n);
    EXPECT_EQ(unlike(rows, 0, exact, 1e-5f), 0) << n;
    EXPECT_EQ(unlike(shot, 0, one_shot, 1e-5f), 0) << n;
  }
  Arrays none(5, 3);
  Pcg32 u(1);
  EXPECT_EQ(sample_n_rounds(gold().exact, {0, 0, -1}, u, none.rows()), 0U);
  EXPECT_EQ(sample_n_rounds(gold().one_shot, {0, 0, -1}, u, none.rows()), 0U);
  for (const float w : none.weight) EXPECT_EQ(w, 0);
  for (const auto valid : none.valid) EXPECT_EQ(valid, 0);
}

TEST(SampleRounds, AModelInLanesIsThatModel) {
  const auto lanes = lane_function(parse_material("ggx:alpha=0.1,f0=1/0.8/0.3"));
  const auto other = lane_function(parse_material("ggx:alpha=0.1,f0=1/0.8/0.5"));  // the twin
  ASSERT_TRUE(lanes && other);
  EXPECT_FALSE(lane_function(parse_material("0.5*ggx:alpha=0.1")));
  EXPECT_FALSE(lane_function(parse_material("ggx + lambert")));
  const std::vector<Direction> wo = many_wo(1000);
  std::vector<Vec2<double>> points;
  Pcg32 random(3);
  for (std::size_t i = 0; i < wo.size(); ++i)
    points.push_back({to_unit_double(random()), to_unit_double(random())});
  const auto differ = [&](const LaneFunction* in_lanes, const auto& draw) {
    Arrays a(wo.size(), 3), b(wo.size(), 3);
    Pcg32 u(1), same(1);
    draw(u, a.rows(), nullptr);
    draw(same, b.rows(), in_lanes);
    int count = 0;
    for (std::size_t i = 0; i < wo.size(); ++i) {
      float worst = length(a.wi[i] - b.wi[i]) + abs(float(a.valid[i]) - float(b.valid[i]));
      worst = max(worst, abs(a.pdf[i] - b.pdf[i]) / max(a.pdf[i], 1e-30f));
      for (std::size_t c = 3 * i; c < 3 * i + 3; ++c)
        worst = max(worst, abs(a.weight[c] - b.weight[c]) / max(a.weight[c], 1e-30f));
      count += !(worst < 1e-5f);
    }
    return count;
  };
  const auto exact = [&](Pcg32& u, const SampleRows& out, const LaneFunction* f) {
    sample_rounds(gold().exact, wo, points, u, out, 200, NoStatistics{}, f);
  };
  const auto by_alias = [&](Pcg32& u, const SampleRows& out, const LaneFunction* f) {
    sample_rounds(gold().one_shot, wo, {}, u, out, 200, f);
  };
  const auto by_point = [&](Pcg32& u, const SampleRows& out, const LaneFunction* f) {
    sample_rounds(gold().one_shot, wo, points, u, out, 200, f);
  };
  const auto many = [&](Pcg32& u, const SampleRows& out, const LaneFunction* f) {
    sample_n_rounds(gold().exact, wo[0], u, out, 200, NoStatistics{}, f);
  };
  EXPECT_EQ(differ(lanes.get(), exact), 0);
  EXPECT_EQ(differ(lanes.get(), by_alias), 0);
  EXPECT_EQ(differ(lanes.get(), by_point), 0);
  EXPECT_EQ(differ(lanes.get(), many), 0);
  EXPECT_GT(differ(other.get(), by_alias), 800);
  EXPECT_GT(differ(other.get(), by_point), 800);
}

TEST(SampleRounds, AFunctionIsCalledOnceARound) {
  const auto calls = std::make_shared<Calls>();
  const Sampler<AnyBrdf> sampler = make_sampler(AnyBrdf(Counted{calls}));
  const std::vector<Direction> wo = many_wo(200'000);
  Arrays rows(wo.size(), 3);
  Pcg32 u(3);
  *calls = {};
  SampleStatistics statistics;
  sample_rounds(sampler.exact, wo, {}, u, rows.rows(), 65536, statistics);
  EXPECT_EQ(calls->directions, statistics.trials);
  EXPECT_GT(calls->directions / calls->count, 10'000U);
  *calls = {};
  sample_rounds(sampler.one_shot, wo, {}, u, rows.rows(), 65536);
  EXPECT_LE(calls->count, 4U);
  *calls = {};
  const std::vector<Vec2<double>> points(wo.size(), {0.3, 0.6});
  sample_rounds(sampler.one_shot, wo, points, u, rows.rows(), 65536);
  EXPECT_LE(calls->count, 5U);
}

// Rounds as a sampler that draws one direction. `stratified`: the first words come from points; `shift`: the
// planted fault, directions of another wo.
ErasedSampler drawn_in_rounds(const ExactSampler<AnyBrdf>& sampler, bool stratified, std::size_t shift) {
  struct State {
    std::vector<Direction> wo = std::vector<Direction>(501, direction_from_angles(1.2f, 1.f));
    Arrays rows = Arrays(501, 3);
    std::size_t next = 501;
  };
  ErasedSampler erased;
  erased.name = "rounds";
  erased.concurrent = false;
  erased.sample = [&sampler, stratified, shift, state = std::make_shared<State>()](Direction wo, Pcg32& u,
                                                                                   DrawnDirection& drawn) {
    if (state->next >= state->wo.size()) {
      for (std::size_t i = 0; i < state->wo.size(); i += 2) state->wo[i] = wo;
      std::vector<Vec2<double>> points;
      for (std::size_t i = 0; stratified && i < state->wo.size(); ++i)
        points.push_back({(double(i) + to_unit_double(u())) / double(state->wo.size()), to_unit_double(u())});
      sample_rounds(sampler, state->wo, points, u, state->rows.rows(), 300);
      state->next = 0;
    }
    const std::size_t k = (state->next + shift) % state->wo.size();
    state->next += 2;
    const Rgb weight{state->rows.weight[3 * k], state->rows.weight[3 * k + 1], state->rows.weight[3 * k + 2]};
    drawn = {state->rows.wi[k], state->rows.pdf[k], sampler.packed().target(weight)};
    return state->rows.valid[k] != 0;
  };
  return erased;
}

TEST(SampleRounds, ExactIsDistributedAsTheTarget) {
  const AnyBrdf& f = gold().exact.brdf();
  const Direction wo = direction_from_angles(0.5f, 2.f);
  const Bins bins = equal_mass_bins(target_function(f), wo);
  const ChiSquareOptions options{.samples = 400'000};
  for (const bool stratified : {false, true}) {
    const Tally right = tally_of(drawn_in_rounds(gold().exact, stratified, 0), bins, options);
    EXPECT_EQ(right.none, 0U);
    // Stratified points vary less than the test expects; they must not vary more.
    for (const CheckResult& r : {check_counts(right, bins, options), check_mean_weight(right, bins, options)})
      EXPECT_TRUE(r.passed) << to_line(r);
    const Tally wrong = tally_of(drawn_in_rounds(gold().exact, stratified, 1), bins, options);
    EXPECT_FALSE(check_counts(wrong, bins, options).passed);
  }
}

}  // namespace
}  // namespace reflectree
