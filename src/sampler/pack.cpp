// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree {

namespace {

// Slabs ascend in theta_o; the lookup ascends in the cosine.
CosineLookup lookup_of(const Partition& partition) {
  std::vector<float> cosines;
  for (const SlabBox& box : slab_boxes(partition)) cosines.push_back(cos(box.lo[0]));
  cosines.push_back(min_cos_theta_o);
  std::reverse(cosines.begin(), cosines.end());
  cosines.back() = 1;
  return CosineLookup(cosines);
}

// Appends a slab with its leaves and alias table; a leaf's height is unit * mass / area. Slabs ascend in
// theta_o, the forest in the cosine. Returns the masses as the alias table has them.
std::vector<std::uint32_t> append(const CanonicalTree& tree, double unit, PackedForest& forest) {
  std::vector<PackedLeaf> leaves;
  std::vector<std::uint32_t> mass;
  PackedSlab slab;
  slab.bucket = pack_leaves(tree, leaves, mass);
  slab.first = std::uint32_t(forest.leaves.size());
  slab.count = std::uint32_t(leaves.size());
  if (!(unit > 0)) unit = 1 / (double(slab.bucket) * slab.count);  // one-shot: a density
  double volume = 0;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    leaves[i].height = float(unit * mass[i] / double(area_of(leaves[i])));
    volume += unit * mass[i];
  }
  slab.volume = float(volume);
  forest.leaves.insert(forest.leaves.end(), leaves.begin(), leaves.end());
  forest.slabs.push_back(slab);
  return mass;
}

std::size_t bytes_of(const PackedForest& forest) {
  return forest.lookup.bytes() + forest.slabs.size() * sizeof(PackedSlab) +
         forest.leaves.size() * sizeof(PackedLeaf) + forest.nodes.size() * sizeof(DescentNode);
}

}  // namespace

PackedSampler pack(const SamplerData& data) {
  validate(data);
  PackedSampler packed;
  packed.domain = data.domain;
  packed.target = data.target;
  packed.albedo = pack(data.albedo);
  packed.exact.lookup = lookup_of(data.exact_partition);
  for (auto tree = data.exact.rbegin(); tree != data.exact.rend(); ++tree) {
    append(*tree, double(tree->volume) / total_mass(*tree), packed.exact);
  }
  packed.one_shot.lookup = lookup_of(data.one_shot_partition);
  for (auto tree = data.one_shot.rbegin(); tree != data.one_shot.rend(); ++tree) {
    const std::vector<std::uint32_t> mass = append(*tree, 0, packed.one_shot);
    packed.one_shot.slabs.back().first_node = std::uint32_t(packed.one_shot.nodes.size());
    append_descent(*tree, mass, packed.one_shot.nodes);
  }
  return packed;
}

std::size_t bytes_of(const PackedSampler& packed) {
  return sizeof packed + bytes_of(packed.exact) + bytes_of(packed.one_shot) + packed.albedo.bytes();
}

}  // namespace reflectree
