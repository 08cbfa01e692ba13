// SPDX-License-Identifier: Apache-2.0
// The run-time layout, made from SamplerData at load: flat arrays, alias tables, guides. Speed work
// changes this and never the file.
#pragma once

#include <vector>

#include "reflectree/sampler/sampler_data.hpp"
#include "reflectree/sampler/square/packed_tree.hpp"

namespace reflectree {

struct PackedForest {
  CosineLookup lookup;
  std::vector<PackedSlab> slabs;  // in order of ascending cos_theta_o
  std::vector<PackedLeaf> leaves;
  std::vector<DescentNode> nodes;  // one-shot only
  const PackedSlab& slab_at(float cos_theta_o) const { return slabs[lookup(cos_theta_o)]; }
};

struct PackedSampler {
  Domain domain;
  Target target;
  PackedForest exact, one_shot;
  PackedAlbedo albedo;
};

// Throws Error if the data is not valid.
PackedSampler pack(const SamplerData& data);
// Bytes of the run-time arrays: exact, one-shot and albedo together.
std::size_t bytes_of(const PackedSampler& packed);

}  // namespace reflectree
