// SPDX-License-Identifier: Apache-2.0
// A round of trials (sample_rounds.hpp): f is called once for all of them.
#pragma once

#include <algorithm>

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
    first_ = 0;
    for (std::size_t b = 0; b <= last_; ++b) {
      compute_points<across_x>(packed_.domain, blocks_[b], *this);
      first_ += places_of(blocks_[b]);
    }
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

}  // namespace reflectree
