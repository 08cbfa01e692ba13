// SPDX-License-Identifier: Apache-2.0
// Many samples of a BRDF chosen at run time, into arrays, in rounds: f is called once for all trials of a
// round. For functions whose call is dear, such as those of another language, and for many channels.
//
//   SampleRows out{wi, pdf, weight, valid};                      // weight: n * channels
//   sample_rounds(sampler.exact, wo, {}, random, out, 65536);    // rejected trials enter the next round
//   sample_rounds(sampler.one_shot, wo, {}, random, out);        // by alias table
//   sample_rounds(sampler.one_shot, wo, points, random, out);    // by monotone descent
//   sample_n_rounds(sampler.exact, wo, random, out);             // many of one wo, divided among the leaves
//
// `lanes`: the formula of sampler.brdf() where it is a model's (lane_function.hpp); f is then not called, and
// the values are the same.
//
// Densities are those of the one-by-one calls. "No sample" is zeros in every array. What f throws is passed
// on; `out` is then unspecified.
#pragma once

#include "reflectree/math/uniform_bits.hpp"
#include "reflectree/simd/trial_round.hpp"

namespace reflectree {

// Exact: out[i] is distributed as sampler.sample(wo[i], u), independent of the others. points: empty, or in
// [0, 1)^2 the first two words of each direction's bits (UniformBits), which choose the leaf
// of its first trial.
template <RandomBits U, class Stats = NoStatistics>
void sample_rounds(const ExactSampler<AnyBrdf>& sampler, std::span<const Direction> wo,
                   std::span<const Vec2<double>> points, U& u, const SampleRows& out,
                   std::size_t trials_per_round = 512, Stats&& stats = {},
                   const LaneFunction* lanes = nullptr) {
  assert(points.empty() || points.size() == wo.size());
  using Field = detail::TrialBlock::Field;
  const PackedSampler& packed = sampler.packed();
  const Domain& domain = packed.domain;
  detail::TrialRound round(sampler.brdf(), packed, sampler.evaluates_turned(),
                           std::min(trials_per_round, wo.size()), lanes);
  struct Pending {
    Incidence in;
    const PackedSlab* slab;
    std::size_t i;
    int trials;
  };
  std::vector<Pending> pending;
  const auto add = [&](const Pending& p) {
    detail::TrialBlock* b = round.room_for(1);
    if (!b) return false;
    std::uint64_t bits = detail::bits64(u);
    if (!points.empty() && p.trials == 0) {
      const auto word = [](double x) { return std::uint64_t(min(x * 0x1p32, 0x1p32 - 1)); };
      bits = (word(points[p.i].x) << 32U) | word(points[p.i].y);
    }
    const PackedLeaf* leaves = packed.exact.leaves.data() + p.slab->first;
    const std::size_t j = b->add(p.i, p.in, detail::choose_leaf(*p.slab, leaves, bits), domain.half(), u);
    b->at[Field::uniform][j] = float(u()) * 0x1p-32f;
    return true;
  };
  for (std::size_t i = 0; i < wo.size() || !pending.empty();) {
    round.clear();
    for (const Pending& p : pending) add(p);
    for (; i < wo.size(); ++i) {
      Pending p{{}, nullptr, i, 0};
      const bool inside = points.empty() || detail::are_uniforms(points[i].x, points[i].y);
      if (!inside || !find_incidence(packed.viewer, wo[i], p.in)) {
        round.store_none(out, i);
        continue;
      }
      p.slab = &packed.exact.slab_at(p.in);
      if (!add(p)) break;
      pending.push_back(p);
    }
    round.compute<detail::AcrossX::place>();
    std::size_t rejected = 0;
    round.for_each([&](detail::TrialBlock& b, std::size_t j, std::size_t k) {
      Pending& p = pending[k];
      if (detail::accept(round, b, j, k, p.in.albedo, out, p.i, stats)) return;
      if (++p.trials < ExactSampler<AnyBrdf>::max_trials) {
        pending[rejected++] = p;
      } else {
        stats.exhausted();
        round.store_none(out, p.i);
      }
    });
    pending.resize(rejected);
  }
}

// One-shot: by alias table, or where points are given by monotone descent from them.
template <RandomBits U>
void sample_rounds(const OneShotSampler<AnyBrdf>& sampler, std::span<const Direction> wo,
                   std::span<const Vec2<double>> points, U& u, const SampleRows& out,
                   std::size_t trials_per_round = 512, const LaneFunction* lanes = nullptr) {
  assert(points.empty() || points.size() == wo.size());
  const PackedSampler& packed = sampler.packed();
  const Domain& domain = packed.domain;
  detail::TrialRound round(sampler.brdf(), packed, sampler.evaluates_turned(),
                           std::min(trials_per_round, wo.size()), lanes);
  const auto no_sample = [&](std::size_t i) { round.store_none(out, i); };
  const auto place_of = [](const detail::TrialBlock& b, std::size_t j) { return std::size_t(b.index[j]); };
  for (std::size_t i = 0; i < wo.size();) {
    round.clear();
    if (points.empty()) {
      for (detail::TrialBlock* b; i < wo.size() && (b = round.room_for(1));)
        detail::add_by_alias(sampler.brdf(), packed, domain, wo, i, u, *b, no_sample);
      round.compute<detail::AcrossX::place>();
    } else {
      for (detail::TrialBlock* b; i < wo.size() && (b = round.room_for(detail::descents_side_by_side));)
        detail::add_by_descent(sampler.brdf(), packed, domain, wo, points, i, *b, no_sample);
      round.compute<detail::AcrossX::uniform>();
    }
    round.store_one_shot(out, place_of);
  }
}

namespace detail {

// Of one wo: fill(round, slab, incidence, filled) fills the places; those that it leaves are "no sample".
// Returns how many were filled.
template <class Sampler, class Fill>
std::size_t fill_rounds(const Sampler& sampler, const PackedForest& forest, Direction wo,
                        const SampleRows& out, std::size_t trials_per_round, const LaneFunction* lanes,
                        const Fill& fill) {
  const PackedSampler& packed = sampler.packed();
  const std::size_t n = out.wi.size();
  TrialRound round(sampler.brdf(), packed, sampler.evaluates_turned(), std::min(trials_per_round, n), lanes);
  std::size_t filled = 0;
  Incidence in;
  if (n > 0 && find_incidence(packed.viewer, wo, in)) fill(round, forest.slab_at(in), in, filled);
  for (std::size_t i = filled; i < n; ++i) round.store_none(out, i);
  return filled;
}

}  // namespace detail

// As sampler.sample_n(wo, u, out): stratified, ordered by leaf within each round, not independent. Returns
// how many places were filled; the others are "no sample".
template <RandomBits U, class Stats = NoStatistics>
std::size_t sample_n_rounds(const ExactSampler<AnyBrdf>& sampler, Direction wo, U& u, const SampleRows& out,
                            std::size_t trials_per_round = 512, Stats&& stats = {},
                            const LaneFunction* lanes = nullptr) {
  using Field = detail::TrialBlock::Field;
  const PackedForest& forest = sampler.packed().exact;
  const bool half = sampler.packed().domain.half();
  const auto fill = [&](detail::TrialRound& round, const PackedSlab& slab, const Incidence& in,
                        std::size_t& filled) {
    const std::size_t n = out.wi.size();
    const auto flush = [&] {
      round.compute<detail::AcrossX::place>();
      round.for_each([&](detail::TrialBlock& b, std::size_t j, std::size_t k) {
        filled += detail::accept(round, b, j, k, in.albedo, out, filled, stats);
      });
      round.clear();
    };
    for (int divided = 0; divided < ExactSampler<AnyBrdf>::max_trials && filled < n; ++divided) {
      detail::divide(slab, forest.leaves.data() + slab.first, n - filled, u,
                     [&](const detail::ChosenLeaf& leaf) {
                       detail::TrialBlock* b = round.room_for(1);
                       if (!b) flush(), b = round.room_for(1);
                       const std::size_t j = b->add(0, in, leaf, half, u);
                       b->at[Field::uniform][j] = float(u()) * 0x1p-32f;
                     });
      flush();
    }
    if (filled < n) stats.exhausted();
  };
  return detail::fill_rounds(sampler, forest, wo, out, trials_per_round, lanes, fill);
}

// One-shot mode likewise; all places are filled or, for "no sample", none.
template <RandomBits U>
std::size_t sample_n_rounds(const OneShotSampler<AnyBrdf>& sampler, Direction wo, U& u, const SampleRows& out,
                            std::size_t trials_per_round = 512, const LaneFunction* lanes = nullptr) {
  const PackedForest& forest = sampler.packed().one_shot;
  const bool half = sampler.packed().domain.half();
  const auto fill = [&](detail::TrialRound& round, const PackedSlab& slab, const Incidence& in,
                        std::size_t& filled) {
    const auto flush = [&] {
      round.compute<detail::AcrossX::place>();
      round.store_one_shot(out, [&](const detail::TrialBlock&, std::size_t) { return filled++; });
      round.clear();
    };
    detail::divide(slab, forest.leaves.data() + slab.first, out.wi.size(), u,
                   [&](const detail::ChosenLeaf& leaf) {
                     detail::TrialBlock* b = round.room_for(1);
                     if (!b) flush(), b = round.room_for(1);
                     b->add(0, in, leaf, half, u);
                   });
    flush();
  };
  return detail::fill_rounds(sampler, forest, wo, out, trials_per_round, lanes, fill);
}

}  // namespace reflectree
