// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/square/packed_tree.hpp"

#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree {

namespace {

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
    PackedLeaf upper = c;
    const auto halve = [&](std::uint16_t PackedLeaf::*middle) {
      const std::uint32_t quarter = half_width(c.*middle) / 2;
      upper.*middle = std::uint16_t(c.*middle + quarter), c.*middle = std::uint16_t(c.*middle - quarter);
    };
    halve(split == TreeSplit::x ? &PackedLeaf::x : &PackedLeaf::y);
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

}  // namespace

std::uint32_t pack_leaves(const CanonicalTree& tree, std::vector<PackedLeaf>& leaves,
                          std::vector<std::uint32_t>& mass) {
  leaves = packed_leaves(tree);
  mass = tree.mass;
  return make_alias_table(mass, leaves.data());
}

void append_descent(const CanonicalTree& tree, const std::vector<std::uint32_t>& mass,
                    std::vector<DescentNode>& nodes) {
  DescentBuilder{tree, mass, nodes}.add();
}

namespace detail {

Located locate(const DescentNode* node, const PackedLeaf* leaf, std::uint32_t count, Symmetry symmetry,
               Vec2<float> p) {
  // The share of each uniform's [0, 1) that leads to the node.
  double lo1 = 0, size1 = 1, lo2 = 0, size2 = 1;
  const SquareCell root = root_cell(symmetry);
  float x0 = root.x0, width = 2, y0 = root.y0, height = root.y1 - root.y0;
  for (std::uint32_t leaves = count; leaves > 1;) {
    const bool x = node->split_x;
    float &start = x ? x0 : y0, &size = x ? width : height;
    double &lo = x ? lo1 : lo2, &share = x ? size1 : size2;
    const double lower = share * double(node->lower);  // as the descent from uniforms rounds it
    const std::uint32_t below_count = node->lower_leaves;
    size *= 0.5f;
    const bool up = (x ? p.x : p.y) >= start + size;
    start += up ? size : 0;
    lo += up ? lower : 0;
    share = up ? share - lower : lower;
    leaves = up ? leaves - below_count : below_count;
    leaf += up ? below_count : 0;
    node += up ? below_count : 1;
  }
  const float gx = float(leaf->slope_x) / 128, gy = float(leaf->slope_y) / 128;
  const float tx = clamp((p.x - x0) / width, 0.f, 1.f), ty = clamp((p.y - y0) / height, 0.f, 1.f);
  Located at;
  at.density = point_at(*leaf, symmetry == Symmetry::mirror, tx, ty).height;
  at.u1 = lo1 + size1 * double(linear_cdf(gx, tx));
  at.u2 = lo2 + size2 * double(linear_cdf(gy, ty));
  return at;
}

}  // namespace detail
}  // namespace reflectree
