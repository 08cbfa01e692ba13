// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree {

namespace {

// Slabs of one coordinate ascend in theta_o; the lookup ascends in the cosine.
CosineLookup lookup_of(const Partition& partition) {
  std::vector<float> cosines;
  for (const SlabBox& box : slab_boxes(partition)) cosines.push_back(cos(box.lo[0]));
  cosines.push_back(min_cos_theta_o);
  std::reverse(cosines.begin(), cosines.end());
  cosines.back() = 1;
  return CosineLookup(cosines);
}

void index(const Partition& partition, const SamplerData& data, PackedForest& forest) {
  if (partition.coordinates.size() == 1) {
    forest.lookup = lookup_of(partition);
  } else {
    forest.tree = SlabTree(partition, data.parameters);
  }
}

// visit(tree) of every slab: of one coordinate in order of the cosine, of more in that of the partition.
template <class Tree, class Visit>
void in_packed_order(const std::vector<Tree>& trees, const Partition& partition, const Visit& visit) {
  if (partition.coordinates.size() == 1) {
    for (auto tree = trees.rbegin(); tree != trees.rend(); ++tree) visit(*tree);
  } else {
    for (const Tree& tree : trees) visit(tree);
  }
}

// Appends a slab with its leaves and alias table; a leaf's height is unit * mass / area. Returns the
// masses as the alias table has them.
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
  return forest.lookup.bytes() + forest.tree.bytes() + forest.slabs.size() * sizeof(PackedSlab) +
         forest.leaves.size() * sizeof(PackedLeaf) + forest.nodes.size() * sizeof(DescentNode);
}

}  // namespace

PackedViewer pack_viewer(const SamplerData& data) {
  PackedViewer viewer{pack(data.albedo), data.frame};
  viewer.family = pack(data.parameters, data.law);
  viewer.turns = data.frame.isotropic() || !data.domain.follows_surface();
  viewer.cos_axis = cos(data.frame.axis), viewer.sin_axis = sin(data.frame.axis);
  return viewer;
}

std::size_t slab_of(const Partition& partition, const Incidence& in) {
  const std::size_t axes = partition.coordinates.size();
  float known[2 + max_parameters] = {theta_of(in.wo), in.phi_o};
  const bool azimuth = axes > 1 && partition.coordinates[1].name == "phi_o";
  const std::size_t of_viewer = azimuth ? 2 : 1;
  std::copy_n(in.coordinates.begin(), axes - of_viewer, known + of_viewer);
  return find_slab(partition, known);
}

PackedSampler pack(const SamplerData& data) {
  validate(data);
  PackedSampler packed;
  packed.domain = data.domain;
  packed.target = data.target;
  packed.viewer = pack_viewer(data);
  index(data.exact_partition, data, packed.exact);
  in_packed_order(data.exact, data.exact_partition, [&](const MajorantTree& tree) {
    append(tree, double(tree.volume) / total_mass(tree), packed.exact);
  });
  index(data.one_shot_partition, data, packed.one_shot);
  in_packed_order(data.one_shot, data.one_shot_partition, [&](const DensityTree& tree) {
    const std::vector<std::uint32_t> mass = append(tree, 0, packed.one_shot);
    packed.one_shot.slabs.back().first_node = std::uint32_t(packed.one_shot.nodes.size());
    append_descent(tree, mass, packed.one_shot.nodes);
  });
  return packed;
}

std::size_t bytes_of(const PackedSampler& packed) {
  return sizeof packed + bytes_of(packed.exact) + bytes_of(packed.one_shot) + packed.viewer.albedo.bytes();
}

}  // namespace reflectree
