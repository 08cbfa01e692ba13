// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "reflectree/sampler/one_shot_sampler.hpp"
#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree {

CosineLookup::CosineLookup(std::vector<float> borders) : borders_(std::move(borders)) {
  const std::uint32_t last = (std::bit_cast<std::uint32_t>(1.f) - base_) >> shift;
  std::size_t i = 0;
  for (std::uint32_t entry = 0; entry <= last; ++entry) {
    const float c = std::bit_cast<float>(base_ + (entry << shift));
    while (i + 2 < borders_.size() && borders_[i + 1] <= c) ++i;
    guide_.push_back(std::uint16_t(i));
  }
}

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

// Walker's alias table in integers (Vose 1991): `bucket` * count = sum(mass), so that every probability is
// exact. The heaviest leaf first takes up what is missing to a multiple of the count.
template <class Leaf>
std::uint32_t make_alias_table(Leaf* leaves, std::uint32_t count) {
  std::uint64_t sum = 0;
  std::uint32_t heaviest = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    sum += leaves[i].mass;
    if (leaves[i].mass > leaves[heaviest].mass) heaviest = i;
  }
  const std::uint64_t bucket = (sum + count - 1) / count;
  leaves[heaviest].mass += std::uint32_t(bucket * count - sum);
  std::vector<std::uint64_t> left(count);
  std::vector<std::uint32_t> small, large;
  for (std::uint32_t i = 0; i < count; ++i) {
    left[i] = leaves[i].mass;
    (left[i] < bucket ? small : large).push_back(i);
  }
  while (!small.empty() && !large.empty()) {
    const std::uint32_t s = small.back(), l = large.back();
    small.pop_back();
    leaves[s].threshold = std::uint32_t(left[s]);
    leaves[s].alias = l;
    left[l] -= bucket - left[s];
    if (left[l] < bucket) {
      large.pop_back();
      small.push_back(l);
    }
  }
  for (const std::uint32_t i : large) leaves[i].threshold = std::uint32_t(bucket), leaves[i].alias = i;
  for (const std::uint32_t i : small) leaves[i].threshold = std::uint32_t(bucket), leaves[i].alias = i;
  return std::uint32_t(bucket);
}

std::vector<PackedCell> packed_cells(const std::vector<Split>& nodes) {
  std::vector<PackedCell> cells, stack{{1, 1}};
  for (const Split split : nodes) {
    const PackedCell c = stack.back();
    stack.pop_back();
    if (split == Split::leaf) {
      cells.push_back(c);
      continue;
    }
    PackedCell lower = c;
    std::uint16_t& axis = split == Split::x ? lower.x : lower.y;
    axis = std::uint16_t(axis << 1U);
    PackedCell upper = lower;
    ++(split == Split::x ? upper.x : upper.y);
    stack.push_back(upper);
    stack.push_back(lower);
  }
  return cells;
}

// Preorder to an array in which the two children of a node are neighbours, with the share of probability of
// the first; returns the mass of the subtree.
struct DescentBuilder {
  const DensityTree& tree;
  const OneShotLeaf* leaves;
  std::vector<DescentNode>& nodes;
  std::size_t base;
  std::size_t next_node = 0;
  std::uint32_t next_leaf = 0;

  double place(std::size_t at) {
    const Split split = tree.nodes[next_node++];
    if (split == Split::leaf) {
      nodes[base + at] = {0, next_leaf, Split::leaf};
      return leaves[next_leaf++].mass;
    }
    const std::size_t child = nodes.size() - base;
    nodes.resize(nodes.size() + 2);
    const double lower = place(child), upper = place(child + 1);
    nodes[base + at] = {lower / (lower + upper), std::uint32_t(child), split};
    return lower + upper;
  }
};

}  // namespace

PackedSampler pack(const SamplerData& data) {
  validate(data);
  PackedSampler packed;
  packed.domain = data.domain;
  packed.target = data.target;
  packed.exact_lookup = lookup_of(data.exact_partition);
  packed.one_shot_lookup = lookup_of(data.one_shot_partition);
  packed.albedo_lookup = CosineLookup(data.albedo.cos_theta_o);
  packed.albedo = data.albedo.albedo;

  for (auto tree = data.exact.rbegin(); tree != data.exact.rend(); ++tree) {
    ExactSlab slab;
    slab.first = std::uint32_t(packed.exact_leaves.size());
    slab.count = std::uint32_t(tree->mass.size());
    const std::vector<PackedCell> cells = packed_cells(tree->nodes);
    double sum = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      packed.exact_leaves.push_back({0, 0, tree->mass[i], cells[i]});
      sum += tree->mass[i];
    }
    slab.unit = std::nextafter(float(double(tree->volume) / sum), 1e30f);
    slab.bucket = make_alias_table(packed.exact_leaves.data() + slab.first, slab.count);
    packed.exact.push_back(slab);
  }
  for (auto tree = data.one_shot.rbegin(); tree != data.one_shot.rend(); ++tree) {
    OneShotSlab slab;
    slab.first = std::uint32_t(packed.one_shot_leaves.size());
    slab.count = std::uint32_t(tree->mass.size());
    const std::vector<PackedCell> cells = packed_cells(tree->nodes);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      packed.one_shot_leaves.push_back({0, 0, tree->mass[i], cells[i], tree->slope_x[i], tree->slope_y[i]});
    }
    OneShotLeaf* leaves = packed.one_shot_leaves.data() + slab.first;
    slab.bucket = make_alias_table(leaves, slab.count);
    slab.unit = float(1 / (double(slab.bucket) * slab.count));
    slab.first_node = std::uint32_t(packed.one_shot_nodes.size());
    packed.one_shot_nodes.emplace_back();
    DescentBuilder{*tree, leaves, packed.one_shot_nodes, slab.first_node}.place(0);
    packed.one_shot.push_back(slab);
  }
  return packed;
}

std::size_t bytes_of(const PackedSampler& p) {
  return p.exact_lookup.bytes() + p.one_shot_lookup.bytes() + p.albedo_lookup.bytes() +
         p.exact.size() * sizeof(ExactSlab) + p.exact_leaves.size() * sizeof(ExactLeaf) +
         p.one_shot.size() * sizeof(OneShotSlab) + p.one_shot_leaves.size() * sizeof(OneShotLeaf) +
         p.one_shot_nodes.size() * sizeof(DescentNode) + p.albedo.size() * sizeof(float) +
         sizeof(PackedSampler);
}

namespace detail {

Located locate(const PackedSampler& packed, const OneShotSlab& slab, Vec2<float> p) {
  const DescentNode* nodes = packed.one_shot_nodes.data() + slab.first_node;
  // The share of each uniform's [0, 1) that leads to the node.
  double lo1 = 0, size1 = 1, lo2 = 0, size2 = 1;
  float x0 = -1, width = 2, y0 = packed.domain.half ? 0.f : -1.f, height = packed.domain.half ? 1.f : 2.f;
  std::uint32_t i = 0;
  while (nodes[i].split != Split::leaf) {
    const bool x = nodes[i].split == Split::x;
    float &start = x ? x0 : y0, &size = x ? width : height;
    double &lo = x ? lo1 : lo2, &share = x ? size1 : size2;
    size *= 0.5f;
    const bool up = (x ? p.x : p.y) >= start + size;
    if (up) {
      start += size;
      lo += share * nodes[i].lower;
      share *= 1 - nodes[i].lower;
    } else {
      share *= nodes[i].lower;
    }
    i = nodes[i].child + up;
  }
  const OneShotLeaf& leaf = packed.one_shot_leaves[slab.first + nodes[i].child];
  const float gx = float(leaf.slope_x) / 128, gy = float(leaf.slope_y) / 128;
  Located at;
  at.leaf = &leaf;
  at.tx = clamp((p.x - x0) / width, 0.f, 1.f);
  at.ty = clamp((p.y - y0) / height, 0.f, 1.f);
  at.density = slab.unit * float(leaf.mass) * unpack(leaf.cell, packed.domain.half).inverse_area *
               (1 + gx * (2 * at.tx - 1)) * (1 + gy * (2 * at.ty - 1));
  at.u1 = lo1 + size1 * double(linear_cdf(gx, at.tx));
  at.u2 = lo2 + size2 * double(linear_cdf(gy, at.ty));
  return at;
}

}  // namespace detail
}  // namespace reflectree
