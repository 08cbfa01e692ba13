// SPDX-License-Identifier: Apache-2.0
// Batches of samples, each of its own wo, several times as fast as one by one. One sample is a long chain of
// dependent operations; here each stage runs over a block of samples: what chooses (slab, leaf, random bits)
// one by one, what computes (point, lift, evaluation, weight) in lanes.
//
//   sample_batch(sampler.exact, wo, random, out);
//   sample_batch(sampler.one_shot, wo, random, out);  // by alias table
//   sample_batch(sampler.one_shot, wo, points, out);  // by monotone descent from points of [0, 1)^2
//
// out.size() == wo.size(). "No sample" has flags 0, pdf 0 and weight 0. Nothing is allocated for a BRDF known
// at compile time.
#pragma once

#include <cassert>

#include "reflectree/sampler/exact_sampler.hpp"
#include "reflectree/sampler/one_shot_sampler.hpp"
#include "reflectree/simd/block_values.hpp"
#include "reflectree/simd/descend.hpp"
#include "reflectree/simd/trial_block.hpp"
#include "reflectree/simd/viewer_stream.hpp"

namespace reflectree {

namespace detail {

template <class Value>
void store_no_sample(const Value& zero, DirectionSample<Value>& out) {
  out = {{}, 0, zero, 0};
}

// Direction, pdf and weight of trial k.
template <class Values, class Value>
REFLECTREE_INLINE void store_sample(const TrialBlock& b, const Values& values, std::size_t k,
                                    DirectionSample<Value>& out) {
  using Field = TrialBlock::Field;
  out = {{b.at[Field::wi_x][k], b.at[Field::wi_y][k], b.at[Field::wi_z][k]},
         b.at[Field::pdf][k],
         scaled_value(values.value(k), b.at[Field::scale][k]),
         sample_reflection};
}

// Fills a block with the next directions from i on, each in a leaf chosen by alias table; no_sample(i) where
// there is none.
template <class F, RandomBits U, class NoSample>
REFLECTREE_INLINE void add_by_alias(const F& f, const PackedSampler& packed, const Domain& domain,
                                    std::span<const Direction> wo, std::size_t& i, U& u, TrialBlock& block,
                                    const NoSample& no_sample) {
  ViewerStream viewers(packed, wo, false);
  with_viewers(f, packed, wo, viewers, [&](const auto& find) REFLECTREE_INLINE_LAMBDA {
    for (; i < wo.size() && !block.full(); ++i) {
      Incidence in;
      if (!find(i, in)) {
        no_sample(i);
        continue;
      }
      const PackedSlab& slab = slab_of<F>(packed.one_shot, in);
      const PackedLeaf* leaves = packed.one_shot.leaves.data() + slab.first;
      block.add(i, in, choose_leaf(slab, leaves, bits64(u)), domain.half(), u);
    }
  });
}

inline constexpr std::size_t descents_side_by_side = 8;
// The same by monotone descent from points of [0, 1]^2.
template <class F, class NoSample>
REFLECTREE_INLINE void add_by_descent(const F& f, const PackedSampler& packed, const Domain& domain,
                                      std::span<const Direction> wo, std::span<const Vec2<double>> points,
                                      std::size_t& i, TrialBlock& block, const NoSample& no_sample) {
  using Field = TrialBlock::Field;
  const bool half = domain.half();
  ViewerStream viewers(packed, wo, false);
  struct Started {
    Incidence in;
    std::size_t i;
    float turn;
  };
  while (i < wo.size() && block.count + descents_side_by_side <= block_size) {
    Descent descents[descents_side_by_side];
    Started started[descents_side_by_side];
    std::size_t n = 0;
    with_viewers(f, packed, wo, viewers, [&](const auto& find) REFLECTREE_INLINE_LAMBDA {
      for (; i < wo.size() && n < descents_side_by_side; ++i) {
        Started& s = started[n];
        if (!are_uniforms(points[i].x, points[i].y) || !find(i, s.in)) {
          no_sample(i);
          continue;
        }
        // Folded continuously across the plane of incidence.
        const bool below = half && points[i].y < 0.5;
        const double u2 = !half ? points[i].y : below ? 1 - 2 * points[i].y : 2 * points[i].y - 1;
        s.i = i;
        s.turn = below ? -0.f : 0.f;
        descents[n++].start(packed.one_shot, slab_of<F>(packed.one_shot, s.in), points[i].x, u2);
      }
    });
    descend(descents, n);
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t k = block.add(started[j].i, started[j].in, *descents[j].leaf, half);
      block.at[Field::across_x][k] = descents[j].across(0);
      block.at[Field::across_y][k] = descents[j].across(1);
      block.at[Field::turn][k] = started[j].turn;
    }
  }
}

// pdf and the factor from f to the weight.
REFLECTREE_INLINE void set_one_shot(TrialBlock& b) {
  using Field = TrialBlock::Field;
  for (std::size_t k = 0; k < b.count; k += lane_count) {
    const Lanes area = b.lanes(Field::projected_area, k), density = b.lanes(Field::majorant, k);
    b.set(Field::pdf, k, density / area * b.lanes(Field::wi_z, k));
    b.set(Field::scale, k, area / density);
  }
}

template <AcrossX across_x, class Values, class Value>
REFLECTREE_INLINE void finish_one_shot(const Domain& domain, TrialBlock& b, Values& values,
                                       std::span<DirectionSample<Value>> out) {
  compute_points<across_x>(domain, b, values);
  set_one_shot(b);
  for (std::size_t k = 0; k < b.count; ++k) store_sample(b, values, k, out[b.index[k]]);
}

// Block after block: add(domain, i, block, no_sample) fills one with the next directions from i on.
template <AcrossX across_x, Brdf F, class Add>
REFLECTREE_INLINE void sample_one_shot_blocks(const OneShotSampler<F>& sampler, std::size_t n,
                                              std::span<DirectionSample<ValueOf<F>>> out, const Add& add) {
  assert(out.size() == n);
  const PackedSampler& packed = sampler.packed();
  TrialBlock block(sampler.evaluates_turned(), !packed.viewer.frame.isotropic());
  BlockValues<F> values(sampler.brdf(), packed.target);
  const auto no_sample = [&](std::size_t i) { store_no_sample(values.zero(), out[i]); };
  const Domain domain = domain_of_all(sampler.brdf(), packed);
  for (std::size_t i = 0; i < n;) {
    block.count = 0;
    add(domain, i, block, no_sample);
    finish_one_shot<across_x>(domain, block, values, out);
  }
}

}  // namespace detail

// One-shot by alias table: out[i] is sampler.sample(wo[i], u), called in order, from the same bits.
template <Brdf F, RandomBits U>
void sample_batch(const OneShotSampler<F>& sampler, std::span<const Direction> wo, U& u,
                  std::span<DirectionSample<ValueOf<F>>> out) {
  detail::sample_one_shot_blocks<detail::AcrossX::place>(
      sampler, wo.size(), out,
      [&](const Domain& domain, std::size_t& i, detail::TrialBlock& block, const auto& no_sample)
          REFLECTREE_INLINE_LAMBDA {
            detail::add_by_alias(sampler.brdf(), sampler.packed(), domain, wo, i, u, block, no_sample);
          });
}

// One-shot by monotone descent: out[i] is sampler.sample(wo[i], points[i].x, points[i].y).
template <Brdf F>
void sample_batch(const OneShotSampler<F>& sampler, std::span<const Direction> wo,
                  std::span<const Vec2<double>> points, std::span<DirectionSample<ValueOf<F>>> out) {
  assert(points.size() == wo.size());
  detail::sample_one_shot_blocks<detail::AcrossX::uniform>(
      sampler, wo.size(), out,
      [&](const Domain& domain, std::size_t& i, detail::TrialBlock& block, const auto& no_sample)
          REFLECTREE_INLINE_LAMBDA {
            detail::add_by_descent(sampler.brdf(), sampler.packed(), domain, wo, points, i, block, no_sample);
          });
}

// Exact: out[i] is distributed as sampler.sample(wo[i], u), independent of the others. Rejected trials begin
// again from the leaf, side by side with the first trials of later directions.
template <Brdf F, RandomBits U, class Stats = NoStatistics>
void sample_batch(const ExactSampler<F>& sampler, std::span<const Direction> wo, U& u,
                  std::span<DirectionSample<ValueOf<F>>> out, Stats&& stats = {}) {
  assert(out.size() == wo.size());
  using Field = detail::TrialBlock::Field;
  const PackedSampler& packed = sampler.packed();
  detail::TrialBlock b(sampler.evaluates_turned(), !packed.viewer.frame.isotropic());
  detail::BlockValues<F> values(sampler.brdf(), packed.target);
  struct Pending {
    Incidence in;
    const PackedSlab* slab;
    std::size_t i;
    int trials;
  };
  Pending pending[detail::block_size];
  detail::ViewerStream viewers(packed, wo, true);
  const Domain domain = detail::domain_of_all(sampler.brdf(), packed);
  std::size_t count = 0;
  for (std::size_t i = 0; i < wo.size() || count > 0;) {
    const auto fill = [&](const auto& find) REFLECTREE_INLINE_LAMBDA {
      for (; i < wo.size() && count < detail::block_size; ++i) {
        Pending& p = pending[count];
        if (!find(i, p.in)) {
          detail::store_no_sample(values.zero(), out[i]);
          continue;
        }
        p.slab = &detail::slab_of<F>(packed.exact, p.in);
        p.i = i;
        p.trials = 0;
        ++count;
      }
    };
    detail::with_viewers(sampler.brdf(), packed, wo, viewers, fill);
    b.count = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Pending& p = pending[k];
      const PackedLeaf* leaves = packed.exact.leaves.data() + p.slab->first;
      b.add(p.i, p.in, detail::choose_leaf(*p.slab, leaves, detail::bits64(u)), domain.half(), u);
      b.at[Field::uniform][k] = float(u()) * 0x1p-32f;
    }
    detail::compute_points<detail::AcrossX::place>(domain, b, values);
    // pdf = t cos_i / a; weight = f_cos / pdf = a f / t, channel by channel: cos_i cancels.
    for (std::size_t k = 0; k < count; k += lane_count) {
      const Lanes t = values.target(k), a = b.lanes(Field::albedo, k);
      b.set(Field::target, k, t * b.lanes(Field::projected_area, k));
      b.set(Field::uniform, k, b.lanes(Field::uniform, k) * (b.lanes(Field::majorant, k) * a));
      b.set(Field::pdf, k, t * b.lanes(Field::wi_z, k) / a);
      b.set(Field::scale, k, a / t);
    }
    std::size_t rejected = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const float target = b.at[Field::target][k];
      const bool accepted = b.at[Field::uniform][k] < target;
      stats.trial(accepted, target / pending[k].in.albedo, b.at[Field::majorant][k]);
      if (accepted) {
        detail::store_sample(b, values, k, out[b.index[k]]);
      } else if (++pending[k].trials < ExactSampler<F>::max_trials) {
        pending[rejected++] = pending[k];
      } else {
        stats.exhausted();
        detail::store_no_sample(values.zero(), out[b.index[k]]);
      }
    }
    count = rejected;
  }
}

}  // namespace reflectree
