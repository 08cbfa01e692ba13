// SPDX-License-Identifier: Apache-2.0
// The run-time layout, made from SamplerData at load: flat arrays, alias tables, guides. Speed work
// changes this and never the file.
#pragma once

#include <vector>

#include "reflectree/sampler/known/incidence.hpp"
#include "reflectree/sampler/known/slab_tree.hpp"
#include "reflectree/sampler/sampler_data.hpp"
#include "reflectree/sampler/square/packed_tree.hpp"

namespace reflectree {

struct PackedForest {
  CosineLookup lookup;            // of isotropic functions
  SlabTree tree;                  // of all others
  std::vector<PackedSlab> slabs;  // in order of ascending cos_theta_o, or of the partition
  std::vector<PackedLeaf> leaves;
  std::vector<DescentNode> nodes;  // one-shot only
  // Of isotropic functions.
  const PackedSlab& slab_at(float cos_theta_o) const { return slabs[lookup(cos_theta_o)]; }
  const PackedSlab& slab_at(const Incidence& in) const {
    if (tree.empty()) return slab_at(in.wo.z);
    const float azimuth = in.azimuth;  // of a copy, so that `in` may stay in registers
    return slabs[tree(in.wo.z, &azimuth)];
  }
  // Of families.
  const PackedSlab& family_slab_at(const Incidence& in) const {
    return slabs[tree(in.wo.z, in.known_beyond.data())];
  }
};

struct PackedSampler {
  Domain domain;
  Target target;
  PackedForest exact, one_shot;
  PackedViewer viewer;
};

namespace detail {

// What a function of type F needs to know of its viewer, where it is a BRDF or a family's member alike.
template <class F>
REFLECTREE_INLINE bool find_incidence_of(const F& f, const PackedSampler& packed, Direction wo,
                                         Incidence& out, bool needs_albedo = true) {
  if constexpr (is_member_v<F>) {
    return find_incidence(packed.viewer, wo, f.at, out, needs_albedo);
  } else {
    return find_incidence(packed.viewer, wo, out, needs_albedo);
  }
}
template <class F>
REFLECTREE_INLINE const PackedSlab& slab_of(const PackedForest& forest, const Incidence& in) {
  if constexpr (is_member_v<F>) {
    return forest.family_slab_at(in);
  } else {
    return forest.slab_at(in);
  }
}
template <class F>
REFLECTREE_INLINE Domain domain_of(const F&, const PackedSampler& packed, const Incidence& in) {
  Domain domain = packed.domain;
  if constexpr (is_member_v<F>) domain.scale_x = in.scale_x, domain.scale_y = in.scale_y;
  return domain;
}
// Of one member, whoever looks.
template <class F>
REFLECTREE_INLINE Domain domain_of_all(const F& f, const PackedSampler& packed) {
  Domain domain = packed.domain;
  if constexpr (is_member_v<F>) {
    const PackedFamily& family = packed.viewer.family;
    Coordinates at;
    // Outside of the range nothing is drawn.
    if (find_coordinates(family, f.at, at))
      domain.scale_x = family.x.at(at), domain.scale_y = family.y.at(at);
  }
  return domain;
}

}  // namespace detail

// The same for who learns at run time whether there are parameters; without any, `at` does not matter.
inline bool find_incidence(const PackedSampler& packed, Direction wo, const Parameters& at, Incidence& out) {
  return packed.viewer.family.count == 0 ? find_incidence(packed.viewer, wo, out)
                                         : find_incidence(packed.viewer, wo, at, out);
}
inline const PackedSlab& slab_at(const PackedSampler& packed, const PackedForest& forest,
                                 const Incidence& in) {
  return packed.viewer.family.count == 0 ? forest.slab_at(in) : forest.family_slab_at(in);
}
inline Domain domain_at(const PackedViewer& viewer, Domain domain, const Incidence& in) {
  if (viewer.family.count > 0) domain.scale_x = in.scale_x, domain.scale_y = in.scale_y;
  return domain;
}

// What is known of its viewers, and the slab of a partition that holds one.
PackedViewer pack_viewer(const SamplerData& data);
std::size_t slab_of(const Partition& partition, const Incidence& in);
// Throws Error if the data is not valid.
PackedSampler pack(const SamplerData& data);
// Bytes of the run-time arrays: exact, one-shot and albedo together.
std::size_t bytes_of(const PackedSampler& packed);

}  // namespace reflectree
