// SPDX-License-Identifier: Apache-2.0
// Exact mode: directions with a density exactly proportional to t cos_i for every wo, whatever the errors
// of any integral; only the bounds matter. One trial: a leaf in proportion to its volume V = area * M, a point
// of it with density q / area (q: the leaf's product-linear shape of mean 1, M q: its bound), accepted with
// probability T / (a M q); after a rejection a leaf is chosen anew. pdf = t cos_i / a(wo),
// where a is the tabulated albedo.
#pragma once

#include <memory>
#include <span>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/sampler/direction_sample.hpp"
#include "reflectree/sampler/known/incidence.hpp"
#include "reflectree/sampler/packed_sampler.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "reflectree/sampler/square/packed_leaf.hpp"
#include "reflectree/sampler/statistics.hpp"

namespace reflectree {

// `Data` points to what is shared; who makes a sampler of a family's member for each sample borrows it.
template <Brdf F, class Data = std::shared_ptr<const PackedSampler>>
class ExactSampler {
 public:
  using Value = ValueOf<F>;
  static constexpr int max_trials = 256;

  ExactSampler(F f, Data packed)
      : f_(std::move(f)),
        packed_(std::move(packed)),
        turned_(is_isotropic_by_formula(f_) && packed_->viewer.frame.isotropic()) {}

  // With f made in its place: a copy of what was just written would have to wait for it.
  template <class... Parts>
  ExactSampler(std::in_place_t, Data packed, const Parts&... parts)
      : f_(parts...),
        packed_(std::move(packed)),
        turned_(is_isotropic_by_formula(f_) && packed_->viewer.frame.isotropic()) {}

  const F& brdf() const { return f_; }
  // Whether f is evaluated in the frame where wo has no y, rather than in the caller's.
  bool evaluates_turned() const { return turned_; }
  const PackedSampler& packed() const { return *packed_; }

  template <RandomBits U, class Stats = NoStatistics>
  std::optional<DirectionSample<Value>> sample(Direction wo, U& u, Stats&& stats = {}) const {
    Incidence in;
    if (!find(wo, in)) return std::nullopt;
    const PackedSlab& slab = slab_of(in);
    return with_known_kind(domain_at(in), [&](const Domain& domain) REFLECTREE_INLINE_LAMBDA {
      for (int trial = 0; trial < max_trials; ++trial) {
        const Candidate c = propose(domain, slab, in, u);
        if (accept(c, in, u, stats)) return std::optional(finish(c, in));
      }
      stats.exhausted();
      return std::optional<DirectionSample<Value>>();
    });
  }

  // Up to out.size() samples in one call; returns how many were filled (all, unless trials ran out). The
  // number wanted is divided among the leaves systematically, one trial each; what was rejected is divided
  // again from the root, since retrying inside the leaf would be biased. Averages over `out` are unbiased;
  // the samples are stratified, ordered by leaf within each round, and not independent.
  template <RandomBits U, class Stats = NoStatistics>
  std::size_t sample_n(Direction wo, U& u, std::span<DirectionSample<Value>> out, Stats&& stats = {}) const {
    Incidence in;
    if (!find(wo, in)) return 0;
    const PackedSlab& slab = slab_of(in);
    const Domain member = domain_at(in);
    std::size_t filled = 0;
    for (int round = 0; round < max_trials && filled < out.size(); ++round) {
      detail::divide(slab, packed_->exact.leaves.data() + slab.first, out.size() - filled, u,
                     [&](const detail::ChosenLeaf& leaf) {
                       const Candidate c = place(member, leaf, in, u);
                       if (accept(c, in, u, stats)) out[filled++] = finish(c, in);
                     });
    }
    if (filled < out.size()) stats.exhausted();
    return filled;
  }

  // One trial. Accepted: weight = sum(V) a f_cos J / min(T, a M q); else nullopt, which counts as weight 0.
  // Unbiased without the albedo table being right and even where a bound is overshot: the referee of both
  // modes. pdf is that of the trial's acceptance: min(T, a M q) cos_i / (sum(V) a J).
  template <RandomBits U>
  std::optional<DirectionSample<Value>> sample_once(Direction wo, U& u) const {
    Incidence in;
    if (!find(wo, in)) return std::nullopt;
    const PackedSlab& slab = slab_of(in);
    const Candidate c = propose(domain_at(in), slab, in, u);
    if (!accept(c, in, u, NoStatistics{})) return std::nullopt;
    const float ratio = c.target / in.albedo;
    const float density = min(ratio, c.majorant) / slab.volume;  // per share of the square
    return DirectionSample<Value>{from_incidence(in, c.point.geometry.wi),
                                  density * c.point.geometry.cos_theta_i / c.point.projected_area,
                                  scaled_value(c.value, c.point.projected_area / density), sample_reflection};
  }

  // Per solid angle, sr^-1: t cos_i / a(wo).
  float pdf(Direction wo, Direction wi) const { return pdf_disk(wo, wi) * max(wi.z, 0.f); }
  // Per projected solid angle: t / a(wo).
  float pdf_disk(Direction wo, Direction wi) const {
    Incidence in;
    if (!(wi.z > 0) || !find(wo, in)) return 0;
    const Value value =
        eval(f_, turned_ ? shading_geometry(in.wo, to_incidence(in, wi)) : shading_geometry(wo, wi));
    return packed_->target(value) / in.albedo;
  }
  // a(wo) of the target, from the table; 0 for no sample.
  float albedo(Direction wo) const {
    Incidence in;
    return find(wo, in) ? in.albedo : 0.f;
  }
  // sum(V) of the slab of wo: the expected trials, up to the error of the albedo table.
  float expected_trials(Direction wo) const {
    Incidence in;
    if (!find(wo, in)) return 0;
    return slab_of(in).volume;
  }

 private:
  struct Candidate {
    DomainPoint point;
    Value value;
    float target;    // T = t * projected_area
    float majorant;  // M q, of T / a
  };

  template <RandomBits U>
  REFLECTREE_INLINE Candidate propose(const Domain& domain, const PackedSlab& slab, const Incidence& in,
                                      U& u) const {
    const PackedLeaf* leaves = packed_->exact.leaves.data() + slab.first;
    return place(domain, detail::choose_leaf(slab, leaves, detail::bits64(u)), in, u);
  }

  template <RandomBits U>
  REFLECTREE_INLINE Candidate place(const Domain& domain, const detail::ChosenLeaf& leaf, const Incidence& in,
                                    U& u) const {
    bool coin;
    const detail::PointInLeaf at = detail::place(leaf, domain.half(), u, coin);
    Candidate c;
    c.point = lift(domain, in.wo, at.p, domain.half() && coin);
    c.majorant = at.height;
    c.value = eval(f_, known_geometry(in, c.point.geometry, turned_));
    c.target = packed_->target(c.value) * c.point.projected_area;
    return c;
  }

  template <RandomBits U, class Stats>
  REFLECTREE_INLINE static bool accept(const Candidate& c, const Incidence& in, U& u, Stats&& stats) {
    const bool accepted = to_unit_double(u()) * double(c.majorant * in.albedo) < double(c.target);
    stats.trial(accepted, c.target / in.albedo, c.majorant);
    return accepted;
  }

  // pdf = t cos_i / a; weight = f_cos / pdf = a f / t, channel by channel: cos_i cancels.
  REFLECTREE_INLINE static DirectionSample<Value> finish(const Candidate& c, const Incidence& in) {
    const float t = c.target / c.point.projected_area;
    return {from_incidence(in, c.point.geometry.wi), t * c.point.geometry.cos_theta_i / in.albedo,
            scaled_value(c.value, in.albedo / t), sample_reflection};
  }

  REFLECTREE_INLINE bool find(Direction wo, Incidence& in) const {
    return detail::find_incidence_of(f_, *packed_, wo, in);
  }
  REFLECTREE_INLINE const PackedSlab& slab_of(const Incidence& in) const {
    return detail::slab_of<F>(packed_->exact, in);
  }
  // With the widths of the member, of families.
  REFLECTREE_INLINE Domain domain_at(const Incidence& in) const {
    return detail::domain_of(f_, *packed_, in);
  }

  F f_;
  Data packed_;
  bool turned_;
};

}  // namespace reflectree
