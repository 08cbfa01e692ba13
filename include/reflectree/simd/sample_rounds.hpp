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

#include <algorithm>

#include "reflectree/math/uniform_bits.hpp"
#include "reflectree/simd/lane_function.hpp"
#include "reflectree/simd/sample_batch.hpp"

namespace reflectree {

// Place i belongs to direction i: wi, pdf per solid angle, weight[i * channels + c] = f_cos / pdf, and
// whether there is a sample.
struct SampleRows {
  std::span<Direction> wi;
  std::span<float> pdf, weight;
  std::span<std::uint8_t> valid;
};

namespace detail {

// Blocks of trials whose function is called once. Trial k of the round is lane j of a block.
class TrialRound {
 public:
  TrialRound(const AnyBrdf& f, const PackedSampler& packed, bool evaluates_turned, std::size_t trials,
             const LaneFunction* lanes)
      : f_(f),
        lanes_(lanes),
        packed_(packed),
        channels_(std::size_t(f.channels())),
        blocks_((std::max<std::size_t>(trials, 1) + block_size - 1) / block_size,
                TrialBlock(evaluates_turned, !packed.viewer.frame.isotropic())),
        geometry_(lanes ? 0 : blocks_.size() * block_size),
        values_(blocks_.size() * block_size * channels_),
        targets_(lanes ? blocks_.size() * block_size : 0),
        trial_stride_(lanes ? 1 : channels_),
        channel_stride_(lanes ? blocks_.size() * block_size : 1) {}

  void clear() {
    for (std::size_t b = 0; b <= last_; ++b) blocks_[b].count = 0;
    last_ = 0;
  }
  // A block with places for so many trials; nullptr: the round is full.
  TrialBlock* room_for(std::size_t trials) {
    if (blocks_[last_].count + trials > block_size) {
      if (last_ + 1 == blocks_.size()) return nullptr;
      ++last_;
    }
    return &blocks_[last_];
  }

  template <AcrossX across_x>
  void compute() {
    with_known_kind(packed_.domain, [&](const Domain& domain) REFLECTREE_INLINE_LAMBDA {
      first_ = 0;
      for (std::size_t b = 0; b <= last_; ++b) {
        compute_points<across_x>(domain, blocks_[b], *this);
        first_ += places_of(blocks_[b]);
      }
    });
    if (!lanes_) f_.eval({geometry_.data(), first_}, {values_.data(), first_ * channels_});
  }
  // visit(block, j, k) for every trial, in the order in which they were added.
  template <class Visit>
  REFLECTREE_INLINE void for_each(const Visit& visit) {
    std::size_t k = 0;
    for (std::size_t b = 0; b <= last_; k += places_of(blocks_[b]), ++b) {
      for (std::size_t j = 0; j < blocks_[b].count; ++j) visit(blocks_[b], j, k + j);
    }
  }

  float target(std::size_t k) const {
    return lanes_ ? targets_[k] : packed_.target(&values_[k * channels_], int(channels_));
  }
  // Direction, pdf and weight of a trial.
  void store(const TrialBlock& b, std::size_t j, std::size_t k, float pdf, float scale, const SampleRows& out,
             std::size_t i) const {
    using Field = TrialBlock::Field;
    out.wi[i] = {b.at[Field::wi_x][j], b.at[Field::wi_y][j], b.at[Field::wi_z][j]};
    out.pdf[i] = pdf;
    for (std::size_t c = 0; c < channels_; ++c)
      out.weight[i * channels_ + c] = scale * values_[k * trial_stride_ + c * channel_stride_];
    out.valid[i] = 1;
  }
  void store_none(const SampleRows& out, std::size_t i) const {
    out.wi[i] = {}, out.pdf[i] = 0, out.valid[i] = 0;
    std::fill_n(out.weight.begin() + std::ptrdiff_t(i * channels_), channels_, 0.f);
  }
  // Of one-shot mode: place_of(block, j) in `out` for every trial.
  template <class PlaceOf>
  void store_one_shot(const SampleRows& out, const PlaceOf& place_of) {
    using Field = TrialBlock::Field;
    for (std::size_t b = 0; b <= last_; ++b) set_one_shot(blocks_[b]);
    for_each([&](TrialBlock& b, std::size_t j, std::size_t k) {
      store(b, j, k, b.at[Field::pdf][j], b.at[Field::scale][j], out, place_of(b, j));
    });
  }

  // Called by compute_points; the copies that fill the last lanes are overwritten by the next block.
  REFLECTREE_INLINE void evaluate(std::size_t k, const ShadingGeometry<Lanes>& g) {
    if (lanes_) return evaluate(first_ + k, (*lanes_)(g));
    for (std::size_t i = 0; i < lane_count; ++i) geometry_[first_ + k + i] = lane_of(g, i);
  }
  void finish(std::size_t) {}

 private:
  // Of a block in geometry_ and values_: lanes keep to blocks, an erased call wants no gaps.
  std::size_t places_of(const TrialBlock& b) const { return lanes_ ? block_size : b.count; }

  REFLECTREE_INLINE void evaluate(std::size_t k, const RgbT<Lanes>& v) {
    float* channel = &values_[k];
    v.r.store(channel);
    v.g.store(channel + channel_stride_);
    v.b.store(channel + 2 * channel_stride_);
    if (packed_.target.kind == TargetKind::norm) {
      Target::norm(Lanes(packed_.target.scale) * v).store(&targets_[k]);
    } else {
      for (std::size_t i = 0; i < lane_count; ++i)
        targets_[k + i] = packed_.target(Rgb{v.r[i], v.g[i], v.b[i]});
    }
  }

  const AnyBrdf& f_;
  const LaneFunction* lanes_;
  const PackedSampler& packed_;
  std::size_t channels_, last_ = 0, first_ = 0;
  std::vector<TrialBlock> blocks_;
  std::vector<ShadingGeometry<float>> geometry_;
  std::vector<float> values_, targets_;
  std::size_t trial_stride_, channel_stride_;  // of values_
};

// Trial k of exact mode: whether it is accepted, and then what it is.
template <class Stats>
REFLECTREE_INLINE bool accept(const TrialRound& round, const TrialBlock& b, std::size_t j, std::size_t k,
                              float albedo, const SampleRows& out, std::size_t i, Stats&& stats) {
  using Field = TrialBlock::Field;
  const float t = round.target(k), target = t * b.at[Field::projected_area][j];
  const float majorant = b.at[Field::majorant][j];
  const bool accepted = b.at[Field::uniform][j] * (majorant * albedo) < target;
  stats.trial(accepted, target / albedo, majorant);
  if (accepted) round.store(b, j, k, t * b.at[Field::wi_z][j] / albedo, albedo / t, out, i);
  return accepted;
}

}  // namespace detail

// Exact: out[i] is distributed as sampler.sample(wo[i], u), independent of the others. points: empty, or in
// [0, 1)^2 the first two words of each direction's bits (UniformBits), which choose the leaf of its first
// trial.
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

// As sampler.sample_n(wo, u, out): stratified, ordered by leaf within each round, not independent. Returns
// how many places were filled; the others are "no sample".
template <RandomBits U, class Stats = NoStatistics>
std::size_t sample_n_rounds(const ExactSampler<AnyBrdf>& sampler, Direction wo, U& u, const SampleRows& out,
                            std::size_t trials_per_round = 512, Stats&& stats = {},
                            const LaneFunction* lanes = nullptr) {
  using Field = detail::TrialBlock::Field;
  const PackedSampler& packed = sampler.packed();
  const Domain& domain = packed.domain;
  const std::size_t n = out.wi.size();
  detail::TrialRound round(sampler.brdf(), packed, sampler.evaluates_turned(), std::min(trials_per_round, n),
                           lanes);
  std::size_t filled = 0;
  Incidence in;
  if (n > 0 && find_incidence(packed.viewer, wo, in)) {
    const PackedSlab& slab = packed.exact.slab_at(in);
    const auto flush = [&] {
      round.compute<detail::AcrossX::place>();
      round.for_each([&](detail::TrialBlock& b, std::size_t j, std::size_t k) {
        filled += detail::accept(round, b, j, k, in.albedo, out, filled, stats);
      });
      round.clear();
    };
    for (int divided = 0; divided < ExactSampler<AnyBrdf>::max_trials && filled < n; ++divided) {
      detail::divide(slab, packed.exact.leaves.data() + slab.first, n - filled, u,
                     [&](const detail::ChosenLeaf& leaf) {
                       detail::TrialBlock* b = round.room_for(1);
                       if (!b) flush(), b = round.room_for(1);
                       const std::size_t j = b->add(0, in, leaf, domain.half(), u);
                       b->at[Field::uniform][j] = float(u()) * 0x1p-32f;
                     });
      flush();
    }
    if (filled < n) stats.exhausted();
  }
  for (std::size_t i = filled; i < n; ++i) round.store_none(out, i);
  return filled;
}

// One-shot mode likewise; all places are filled or, for "no sample", none.
template <RandomBits U>
std::size_t sample_n_rounds(const OneShotSampler<AnyBrdf>& sampler, Direction wo, U& u, const SampleRows& out,
                            std::size_t trials_per_round = 512, const LaneFunction* lanes = nullptr) {
  const PackedSampler& packed = sampler.packed();
  const Domain& domain = packed.domain;
  const std::size_t n = out.wi.size();
  detail::TrialRound round(sampler.brdf(), packed, sampler.evaluates_turned(), std::min(trials_per_round, n),
                           lanes);
  std::size_t filled = 0;
  Incidence in;
  if (n > 0 && find_incidence(packed.viewer, wo, in)) {
    const PackedSlab& slab = packed.one_shot.slab_at(in);
    const auto flush = [&] {
      round.compute<detail::AcrossX::place>();
      round.store_one_shot(out, [&](const detail::TrialBlock&, std::size_t) { return filled++; });
      round.clear();
    };
    detail::divide(slab, packed.one_shot.leaves.data() + slab.first, n, u,
                   [&](const detail::ChosenLeaf& leaf) {
                     detail::TrialBlock* b = round.room_for(1);
                     if (!b) flush(), b = round.room_for(1);
                     b->add(0, in, leaf, domain.half(), u);
                   });
    flush();
  }
  for (std::size_t i = filled; i < n; ++i) round.store_none(out, i);
  return filled;
}

}  // namespace reflectree
