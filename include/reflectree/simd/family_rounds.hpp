// SPDX-License-Identifier: Apache-2.0
// Many samples of a family chosen at run time, each of a member of its own, into arrays, in rounds
// (sample_rounds.hpp): f is called once for all trials of a round. For functions whose call is dear.
//
//   sample_rounds(sampler.exact, wo, alpha, random, out, 65536);            // alpha: Parameters of each
//   sample_rounds(sampler.one_shot, wo, alpha, points, random, out, 65536);  // points: empty, or uniforms
//
// "No sample" is zeros in every array. What f throws is passed on; `out` is then unspecified.
#pragma once

#include <cassert>

#include "reflectree/sampler/family_sampler.hpp"
#include "reflectree/simd/trial_round.hpp"

namespace reflectree {

namespace detail {

inline void store_none(const SampleRows& out, std::size_t i, std::size_t channels) {
  out.wi[i] = {}, out.pdf[i] = 0, out.valid[i] = 0;
  std::fill_n(out.weight.begin() + std::ptrdiff_t(i * channels), channels, 0.f);
}
inline void store(const SampleRows& out, std::size_t i, Direction wi, float pdf, const float* value,
                  float scale, std::size_t channels) {
  out.wi[i] = wi, out.pdf[i] = pdf, out.valid[i] = 1;
  for (std::size_t c = 0; c < channels; ++c) out.weight[i * channels + c] = value[c] * scale;
}

// A function whose weights are f_cos / pdf of f = 1.
struct UnitFamily {
  float operator()(const ShadingGeometry<float>&, const Parameters&) const { return 1; }
};

}  // namespace detail

// Exact: out[i] is distributed as sampler.sample(wo[i], at[i], u), independent of the others.
template <RandomBits U>
void sample_rounds(const FamilyMode<ExactSampler, AnyFamily>& sampler, std::span<const Direction> wo,
                   std::span<const Parameters> at, U& u, const SampleRows& out,
                   std::size_t trials_per_round = 512) {
  assert(at.size() == wo.size());
  constexpr int max_trials = ExactSampler<AnyBrdf>::max_trials;
  const PackedSampler& packed = sampler.packed();
  const AnyFamily& f = sampler.family().f;
  const auto channels = std::size_t(f.channels());
  struct Trial {
    std::size_t i;
    int rejected;
    Incidence in;
    const PackedSlab* slab;
    DomainPoint point;
    float majorant;  // of T / a
  };
  std::vector<Trial> open;
  std::vector<ShadingGeometry<float>> geometry;
  std::vector<Parameters> members;
  std::vector<float> values;
  for (std::size_t i = 0; i < wo.size() || !open.empty();) {
    for (; i < wo.size() && open.size() < trials_per_round; ++i) {
      Trial t{i, 0, {}, nullptr, {}, 0};
      if (find_incidence(packed.viewer, wo[i], at[i], t.in)) {
        t.slab = &packed.exact.family_slab_at(t.in);
        open.push_back(t);
      } else {
        detail::store_none(out, i, channels);
      }
    }
    geometry.clear(), members.clear();
    for (Trial& t : open) {
      const Domain domain = domain_at(packed.viewer, packed.domain, t.in);
      const PackedLeaf* leaves = packed.exact.leaves.data() + t.slab->first;
      bool coin;
      const detail::PointInLeaf p =
          detail::place(detail::choose_leaf(*t.slab, leaves, detail::bits64(u)), domain.half(), u, coin);
      t.point = lift(domain, t.in.wo, p.p, domain.half() && coin);
      t.majorant = p.height;
      geometry.push_back(known_geometry(t.in, t.point.geometry, false));
      members.push_back(at[t.i]);
    }
    values.resize(open.size() * channels);
    f.eval(geometry, members, values);
    std::size_t rejected = 0;
    for (std::size_t k = 0; k < open.size(); ++k) {
      Trial& t = open[k];
      const float* value = &values[k * channels];
      const float target = packed.target(value, int(channels));
      if (to_unit_double(u()) * double(t.majorant * t.in.albedo) < double(target * t.point.projected_area)) {
        detail::store(out, t.i, geometry[k].wi, target * geometry[k].cos_theta_i / t.in.albedo, value,
                      t.in.albedo / target, channels);
      } else if (++t.rejected < max_trials) {
        open[rejected++] = t;
      } else {
        detail::store_none(out, t.i, channels);
      }
    }
    open.resize(rejected);
  }
}

// One-shot: by alias table, or where points are given by monotone descent from them.
template <RandomBits U>
void sample_rounds(const FamilyMode<OneShotSampler, AnyFamily>& sampler, std::span<const Direction> wo,
                   std::span<const Parameters> at, std::span<const Vec2<double>> points, U& u,
                   const SampleRows& out, std::size_t trials_per_round = 512) {
  assert(at.size() == wo.size() && (points.empty() || points.size() == wo.size()));
  const AnyFamily& f = sampler.family().f;
  const auto channels = std::size_t(f.channels());
  const detail::UnitFamily unit;
  std::vector<DirectionSample<float>> drawn;
  std::vector<std::size_t> place;
  std::vector<ShadingGeometry<float>> geometry;
  std::vector<Parameters> members;
  std::vector<float> values;
  for (std::size_t i = 0; i < wo.size();) {
    drawn.clear(), place.clear(), geometry.clear(), members.clear();
    for (; i < wo.size() && drawn.size() < trials_per_round; ++i) {
      const OneShotSampler<FamilyMember<detail::UnitFamily>, const PackedSampler*> member(
          std::in_place, &sampler.packed(), &unit, at[i]);
      const auto s =
          points.empty() ? member.sample(wo[i], u) : member.sample(wo[i], points[i].x, points[i].y);
      if (!s) {
        detail::store_none(out, i, channels);
        continue;
      }
      drawn.push_back(*s), place.push_back(i);
      geometry.push_back(shading_geometry(wo[i], s->wi)), members.push_back(at[i]);
    }
    values.resize(drawn.size() * channels);
    f.eval(geometry, members, values);
    for (std::size_t k = 0; k < drawn.size(); ++k)
      detail::store(out, place[k], drawn[k].wi, drawn[k].pdf, &values[k * channels], drawn[k].weight,
                    channels);
  }
}

}  // namespace reflectree
