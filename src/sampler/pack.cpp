// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "reflectree/sampler/one_shot_sampler.hpp"
#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree {

CosineLookup::CosineLookup(std::vector<float> borders) : borders_(std::move(borders)) {
  borders_.back() = 2;  // so that every search ends
  // Refine the guide until no entry spans two borders, up to 256 entries an octave.
  for (shift_ = 19; shift_ > 15;) {
    --shift_;
    guide_.clear();
    std::size_t i = 0, crowded = 0;
    for (std::uint32_t entry = 0; entry <= (std::bit_cast<std::uint32_t>(1.f) - base_) >> shift_; ++entry) {
      const float c = std::bit_cast<float>(base_ + (entry << shift_));
      const std::size_t before = i;
      while (borders_[i + 1] <= c) ++i;
      crowded += i > before + 1;
      guide_.push_back(std::uint16_t(i));
    }
    if (crowded == 0) break;
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
std::uint32_t make_alias_table(std::vector<std::uint32_t>& mass, PackedLeaf* leaves) {
  const auto count = std::uint32_t(mass.size());
  std::uint64_t sum = 0;
  std::uint32_t heaviest = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    sum += mass[i];
    if (mass[i] > mass[heaviest]) heaviest = i;
  }
  const std::uint64_t bucket = (sum + count - 1) / count;
  mass[heaviest] += std::uint32_t(bucket * count - sum);
  std::vector<std::uint64_t> left(mass.begin(), mass.end());
  std::vector<std::uint32_t> small, large;
  for (std::uint32_t i = 0; i < count; ++i) (left[i] < bucket ? small : large).push_back(i);
  while (!small.empty() && !large.empty()) {
    const std::uint32_t s = small.back(), l = large.back();
    small.pop_back();
    leaves[s].threshold = std::uint32_t(left[s]);
    leaves[s].alias = std::uint16_t(l);
    left[l] -= bucket - left[s];
    if (left[l] < bucket) {
      large.pop_back();
      small.push_back(l);
    }
  }
  for (const auto* rest : {&large, &small}) {
    for (const std::uint32_t i : *rest)
      leaves[i].threshold = std::uint32_t(bucket), leaves[i].alias = std::uint16_t(i);
  }
  return std::uint32_t(bucket);
}

// Leaves in preorder with their cells and slopes.
std::vector<PackedLeaf> packed_leaves(const CanonicalTree& tree) {
  std::vector<PackedLeaf> leaves, stack{{}};
  for (const TreeSplit split : tree.nodes) {
    PackedLeaf c = stack.back();
    stack.pop_back();
    if (split == TreeSplit::leaf) {
      c.slope_x = tree.slope_x[leaves.size()], c.slope_y = tree.slope_y[leaves.size()];
      leaves.push_back(c);
      continue;
    }
    const std::uint8_t level = ++(split == TreeSplit::x ? c.level_x : c.level_y);
    PackedLeaf upper = c;
    std::uint16_t& start = split == TreeSplit::x ? upper.x : upper.y;
    start = std::uint16_t(start + (0x8000U >> level));
    stack.push_back(upper);
    stack.push_back(c);
  }
  return leaves;
}

// Appends the inner nodes of a subtree in preorder.
struct DescentBuilder {
  const CanonicalTree& tree;
  const std::vector<std::uint32_t>& mass;
  std::vector<DescentNode>& nodes;
  std::size_t next_node = 0;
  std::uint32_t next_leaf = 0;

  struct Subtree {
    double mass;
    std::uint32_t leaves;
  };
  Subtree add() {
    const TreeSplit split = tree.nodes[next_node++];
    if (split == TreeSplit::leaf) return {double(mass[next_leaf++]), 1};
    const std::size_t at = nodes.size();
    nodes.emplace_back();
    const Subtree lower = add(), upper = add();
    nodes[at].lower = float(lower.mass / (lower.mass + upper.mass));
    nodes[at].lower_leaves = lower.leaves & 0x7fffffffU;
    nodes[at].split_x = split == TreeSplit::x;
    return {lower.mass + upper.mass, lower.leaves + upper.leaves};
  }
};

// Appends a slab with its leaves and alias table; a leaf's height is unit * mass / area. Slabs ascend in
// theta_o, the forest in the cosine. Returns the masses as the alias table has them.
std::vector<std::uint32_t> append(const CanonicalTree& tree, double unit, PackedForest& forest) {
  std::vector<PackedLeaf> leaves = packed_leaves(tree);
  std::vector<std::uint32_t> mass = tree.mass;
  PackedSlab slab;
  slab.first = std::uint32_t(forest.leaves.size());
  slab.count = std::uint32_t(leaves.size());
  slab.bucket = make_alias_table(mass, leaves.data());
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
  packed.albedo_lookup = CosineLookup(data.albedo.cos_theta_o);
  for (std::size_t i = 0; i + 1 < data.albedo.albedo.size(); ++i) {
    const double c0 = double(data.albedo.cos_theta_o[i]), c1 = double(data.albedo.cos_theta_o[i + 1]);
    const double a0 = double(data.albedo.albedo[i]), a1 = double(data.albedo.albedo[i + 1]);
    const double slope = (a1 - a0) / (c1 - c0);
    packed.albedo.push_back({float(a0 - slope * c0), float(slope)});
  }
  packed.exact.lookup = lookup_of(data.exact_partition);
  for (auto tree = data.exact.rbegin(); tree != data.exact.rend(); ++tree) {
    double sum = 0;
    for (const std::uint32_t m : tree->mass) sum += m;
    append(*tree, double(tree->volume) / sum, packed.exact);
  }
  packed.one_shot.lookup = lookup_of(data.one_shot_partition);
  for (auto tree = data.one_shot.rbegin(); tree != data.one_shot.rend(); ++tree) {
    const std::vector<std::uint32_t> mass = append(*tree, 0, packed.one_shot);
    packed.one_shot.slabs.back().first_node = std::uint32_t(packed.one_shot.nodes.size());
    DescentBuilder{*tree, mass, packed.one_shot.nodes}.add();
  }
  return packed;
}

std::size_t bytes_of(const PackedSampler& packed) {
  return sizeof packed + bytes_of(packed.exact) + bytes_of(packed.one_shot) + packed.albedo_lookup.bytes() +
         packed.albedo.size() * sizeof(AlbedoPiece);
}

namespace detail {

Located locate(const PackedSampler& packed, const PackedSlab& slab, Vec2<float> p) {
  const DescentNode* node = packed.one_shot.nodes.data() + slab.first_node;
  const PackedLeaf* leaf = packed.one_shot.leaves.data() + slab.first;
  // The share of each uniform's [0, 1) that leads to the node.
  double lo1 = 0, size1 = 1, lo2 = 0, size2 = 1;
  float x0 = -1, width = 2, y0 = packed.domain.half ? 0.f : -1.f, height = packed.domain.half ? 1.f : 2.f;
  for (std::uint32_t leaves = slab.count; leaves > 1;) {
    const bool x = node->split_x;
    float &start = x ? x0 : y0, &size = x ? width : height;
    double &lo = x ? lo1 : lo2, &share = x ? size1 : size2;
    const double lower = double(node->lower);
    const std::uint32_t below_count = node->lower_leaves;
    size *= 0.5f;
    if ((x ? p.x : p.y) < start + size) {
      share *= lower;
      leaves = below_count;
      ++node;
    } else {
      start += size;
      lo += share * lower;
      share *= 1 - lower;
      leaves -= below_count;
      leaf += below_count;
      node += below_count;
    }
  }
  const float gx = float(leaf->slope_x) / 128, gy = float(leaf->slope_y) / 128;
  const float tx = clamp((p.x - x0) / width, 0.f, 1.f), ty = clamp((p.y - y0) / height, 0.f, 1.f);
  Located at;
  at.density = point_at(*leaf, packed.domain.half, tx, ty).height;
  at.u1 = lo1 + size1 * double(linear_cdf(gx, tx));
  at.u2 = lo2 + size2 * double(linear_cdf(gy, ty));
  return at;
}

}  // namespace detail
}  // namespace reflectree
