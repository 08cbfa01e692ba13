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
    return tree.empty() ? slab_at(in.wo.z) : slabs[tree(in.wo.z, in.phi_o)];
  }
};

struct PackedSampler {
  Domain domain;
  Target target;
  PackedForest exact, one_shot;
  PackedViewer viewer;
};

// What is known of its viewers, and the slab of a partition that holds one.
PackedViewer pack_viewer(const SamplerData& data);
std::size_t slab_of(const Partition& partition, const Incidence& in);
// Throws Error if the data is not valid.
PackedSampler pack(const SamplerData& data);
// Bytes of the run-time arrays: exact, one-shot and albedo together.
std::size_t bytes_of(const PackedSampler& packed);

}  // namespace reflectree
