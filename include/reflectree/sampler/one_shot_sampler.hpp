// SPDX-License-Identifier: Apache-2.0
// One-shot mode: no rejection; two uniforms in, a direction out; the density is the tree's own,
// product-linear in each leaf, and never evaluates f. Always unbiased; the weight f_cos / pdf varies a little
// instead. Two ways in: an alias table (fastest, not monotone), and a monotone descent for QMC points,
// with its inverse.
#pragma once

#include <memory>
#include <span>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/sampler/direction_sample.hpp"
#include "reflectree/sampler/known/incidence.hpp"
#include "reflectree/sampler/packed_sampler.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree {

namespace detail {

REFLECTREE_INLINE bool are_uniforms(double u1, double u2) { return u1 >= 0 && u1 <= 1 && u2 >= 0 && u2 <= 1; }

}  // namespace detail

// `Data` points to what is shared; who makes a sampler of a family's member for each sample borrows it.
template <Brdf F, class Data = std::shared_ptr<const PackedSampler>>
class OneShotSampler {
 public:
  using Value = ValueOf<F>;

  OneShotSampler(F f, Data packed)
      : f_(std::move(f)),
        packed_(std::move(packed)),
        turned_(is_isotropic_by_formula(f_) && packed_->viewer.frame.isotropic()) {}

  // With f made in its place: a copy of what was just written would have to wait for it.
  template <class... Parts>
  OneShotSampler(std::in_place_t, Data packed, const Parts&... parts)
      : f_(parts...),
        packed_(std::move(packed)),
        turned_(is_isotropic_by_formula(f_) && packed_->viewer.frame.isotropic()) {}

  const F& brdf() const { return f_; }
  // Whether f is evaluated in the frame where wo has no y, rather than in the caller's.
  bool evaluates_turned() const { return turned_; }
  const PackedSampler& packed() const { return *packed_; }

  // By alias table, from 128 random bits.
  template <RandomBits U>
  std::optional<DirectionSample<Value>> sample(Direction wo, U& u) const {
    return in_chosen_leaf<DirectionSample<Value>>(
        wo, u,
        [&](const Domain& domain, const detail::ChosenLeaf& leaf, const Incidence& in)
            REFLECTREE_INLINE_LAMBDA { return sample_in(domain, leaf, in, u); });
  }

  // The same without f, for who evaluates many together.
  template <RandomBits U>
  std::optional<Proposal> propose(Direction wo, U& u) const {
    return in_chosen_leaf<Proposal>(
        wo, u,
        [&](const Domain& domain, const detail::ChosenLeaf& leaf, const Incidence& in)
            REFLECTREE_INLINE_LAMBDA {
              bool coin;
              const detail::PointInLeaf at = detail::place(leaf, domain.half(), u, coin);
              return proposal(domain, in, at, domain.half() && coin);
            });
  }

  // out.size() samples in one call, divided among the leaves systematically; returns how many were filled
  // (all or, for "no sample", none). Stratified, ordered by leaf, not independent; averages are unbiased.
  template <RandomBits U>
  std::size_t sample_n(Direction wo, U& u, std::span<DirectionSample<Value>> out) const {
    Incidence in;
    if (out.empty() || !find(wo, in)) return 0;
    const PackedSlab& slab = slab_of(in);
    const Domain member = domain_at(in);
    std::size_t filled = 0;
    detail::divide(slab, packed_->one_shot.leaves.data() + slab.first, out.size(), u,
                   [&](const detail::ChosenLeaf& leaf) { out[filled++] = sample_in(member, leaf, in, u); });
    return filled;
  }

  // By monotone descent from two uniforms in [0, 1): stratified and QMC points stay stratified. Uniforms
  // outside of [0, 1] are no sample.
  std::optional<DirectionSample<Value>> sample(Direction wo, double u1, double u2) const {
    Incidence in;
    if (!detail::are_uniforms(u1, u2) || !find(wo, in)) return std::nullopt;
    const PackedSlab& slab = slab_of(in);
    const bool half = packed_->domain.half(), below = half && u2 < 0.5;
    if (half) u2 = below ? 1 - 2 * u2 : 2 * u2 - 1;  // continuous across the plane of incidence
    const DescentNode* node = packed_->one_shot.nodes.data() + slab.first_node;
    const PackedLeaf* leaf = packed_->one_shot.leaves.data() + slab.first;
    // The share [lo, lo + size) of each uniform that leads here; axis 0 is x.
    double lo[2] = {0, 0}, size[2] = {1, 1};
    const double uniform[2] = {u1, u2};
    for (std::uint32_t leaves = slab.count; leaves > 1;) {
      const std::size_t axis = 1 - node->split_x;
      const double lower = size[axis] * double(node->lower);
      const std::uint32_t below_count = node->lower_leaves;
      const bool up = uniform[axis] >= lo[axis] + lower;
      lo[axis] += up ? lower : 0;
      size[axis] = up ? size[axis] - lower : lower;
      leaves = up ? leaves - below_count : below_count;
      leaf += up ? below_count : 0;
      node += up ? below_count : 1;
    }
    u1 = (u1 - lo[0]) / size[0];
    u2 = (u2 - lo[1]) / size[1];
    const detail::PointInLeaf at = detail::place(*leaf, half, min(float(u1), 1.f), min(float(u2), 1.f));
    return with_known_kind(domain_at(in), [&](const Domain& domain) REFLECTREE_INLINE_LAMBDA {
      return std::optional(finish(domain, in, at, below));
    });
  }

  // The uniforms that `sample(wo, u1, u2)` takes to wi, up to rounding; nullopt below the horizon.
  std::optional<Vec2<double>> invert(Direction wo, Direction wi) const {
    Incidence in;
    if (!(wi.z > 0) || !find(wo, in)) return std::nullopt;
    const bool half = packed_->domain.half();
    Direction local = to_incidence(in, wi);
    const bool below = half && local.y < 0;
    if (half) local.y = abs(local.y);
    const PackedSlab& slab = slab_of(in);
    const detail::Located at = locate(slab, lower(domain_at(in), in.wo, local));
    return Vec2<double>{at.u1, !half ? at.u2 : below ? 0.5 * (1 - at.u2) : 0.5 * (1 + at.u2)};
  }

  // Per solid angle, sr^-1; by point location, without evaluating f.
  float pdf(Direction wo, Direction wi) const {
    Incidence in;
    if (!(wi.z > 0) || !find(wo, in)) return 0;
    Direction local = to_incidence(in, wi);
    const Domain member = domain_at(in);
    local = fold(member.symmetry, local);
    const Vec2<float> p = lower(member, in.wo, local);
    const DomainPoint point = lift(member, in.wo, p);
    return locate(slab_of(in), p).density * point.geometry.cos_theta_i / point.projected_area;
  }
  // Per projected solid angle.
  float pdf_disk(Direction wo, Direction wi) const { return wi.z > 0 ? pdf(wo, wi) / wi.z : 0.f; }

 private:
  detail::Located locate(const PackedSlab& slab, Vec2<float> p) const {
    const PackedForest& forest = packed_->one_shot;
    return detail::locate(forest.nodes.data() + slab.first_node, forest.leaves.data() + slab.first,
                          slab.count, packed_->domain.symmetry, p);
  }

  // make(domain, leaf, incidence), for a leaf chosen by alias table.
  template <class Made, RandomBits U, class Make>
  REFLECTREE_INLINE std::optional<Made> in_chosen_leaf(Direction wo, U& u, const Make& make) const {
    Incidence in;
    if (!find(wo, in)) return std::nullopt;
    const PackedSlab& slab = slab_of(in);
    const detail::ChosenLeaf leaf =
        detail::choose_leaf(slab, packed_->one_shot.leaves.data() + slab.first, detail::bits64(u));
    return with_known_kind(domain_at(in), [&](const Domain& domain) REFLECTREE_INLINE_LAMBDA {
      return std::optional<Made>(make(domain, leaf, in));
    });
  }

  template <RandomBits U>
  REFLECTREE_INLINE DirectionSample<Value> sample_in(const Domain& domain, const detail::ChosenLeaf& leaf,
                                                     const Incidence& in, U& u) const {
    bool coin;
    const detail::PointInLeaf at = detail::place(leaf, domain.half(), u, coin);
    return finish(domain, in, at, domain.half() && coin);
  }

  REFLECTREE_INLINE DirectionSample<Value> finish(const Domain& domain, const Incidence& in,
                                                  const detail::PointInLeaf& at, bool mirrored) const {
    const Proposal p = proposal(domain, in, at, mirrored);
    return {p.wi, p.pdf, scaled_value(eval(f_, p.geometry), p.scale), sample_reflection};
  }

  REFLECTREE_INLINE Proposal proposal(const Domain& domain, const Incidence& in,
                                      const detail::PointInLeaf& at, bool mirrored) const {
    const DomainPoint point = lift(domain, in.wo, at.p, mirrored);
    const float pdf_disk = at.height / point.projected_area, inverse = point.projected_area / at.height;
    return {from_incidence(in, point.geometry.wi), pdf_disk * point.geometry.cos_theta_i,
            known_geometry(in, point.geometry, turned_), inverse};
  }

  REFLECTREE_INLINE bool find(Direction wo, Incidence& in) const {
    return detail::find_incidence_of(f_, *packed_, wo, in, false);
  }
  REFLECTREE_INLINE const PackedSlab& slab_of(const Incidence& in) const {
    return detail::slab_of<F>(packed_->one_shot, in);
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
