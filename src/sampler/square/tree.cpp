// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/square/tree.hpp"

#include <algorithm>

#include "reflectree/error.hpp"

namespace reflectree {

void validate(const CanonicalTree& tree, const std::string& where) {
  const auto fail = [&](const char* what) { throw Error(what, where, "build the sampler again"); };
  struct Levels {
    int x, y;
  };
  std::vector<Levels> stack{{0, 0}};
  std::size_t leaves = 0;
  for (const TreeSplit split : tree.nodes) {
    if (stack.empty()) fail("the tree goes on after its end");
    const Levels l = stack.back();
    stack.pop_back();
    if (split == TreeSplit::leaf) {
      ++leaves;
      continue;
    }
    if (split != TreeSplit::x && split != TreeSplit::y) fail("unknown kind of node");
    const Levels child{l.x + (split == TreeSplit::x), l.y + (split == TreeSplit::y)};
    if (child.x > 15 || child.y > 15) fail("the tree is deeper than 15 levels per axis");
    stack.push_back(child);
    stack.push_back(child);
  }
  if (!stack.empty()) fail("the tree is incomplete");
  if (leaves > 65535) fail("more than 65535 leaves");
  if (tree.mass.size() != leaves || tree.slope_x.size() != leaves || tree.slope_y.size() != leaves) {
    fail("one mass and two slopes per leaf are needed");
  }
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < leaves; ++i) {
    if (tree.mass[i] == 0) fail("a leaf has lost its support (mass 0)");
    if (tree.slope_x[i] == -128 || tree.slope_y[i] == -128) fail("a slope empties an edge of its leaf");
    sum += tree.mass[i];
  }
  if (sum > 0xffffffffULL) fail("the masses sum to more than 2^32 - 1");
}

double total_mass(const CanonicalTree& tree) {
  double sum = 0;
  for (const std::uint32_t m : tree.mass) sum += m;
  return sum;
}

SquareHalves halves_of(const SquareCell& c, TreeSplit split) {
  SquareHalves halves{c, c};
  if (split == TreeSplit::x) {
    halves.lower.x1 = halves.upper.x0 = 0.5f * (c.x0 + c.x1);
  } else {
    halves.lower.y1 = halves.upper.y0 = 0.5f * (c.y0 + c.y1);
  }
  return halves;
}

std::vector<SquareCell> leaf_cells(const std::vector<TreeSplit>& nodes, Symmetry symmetry) {
  std::vector<SquareCell> cells;
  for_each_node(nodes, symmetry, [&](TreeSplit split, const SquareCell& cell) {
    if (split == TreeSplit::leaf) cells.push_back(cell);
  });
  return cells;
}

LeafFinder::LeafFinder(const std::vector<TreeSplit>& nodes, Symmetry symmetry) : symmetry_(symmetry) {
  const auto fail = [] { throw Error("the tree is not complete", "leaf finder", "validate() the sampler"); };
  // Preorder: an inner node's upper child follows the whole lower subtree. Read backwards, the starts of
  // finished subtrees lie on a stack, the lower one on top.
  nodes_.resize(nodes.size());
  std::vector<std::size_t> starts;
  auto leaves = std::size_t(std::count(nodes.begin(), nodes.end(), TreeSplit::leaf));
  for (std::size_t i = nodes.size(); i-- > 0;) {
    if (nodes[i] == TreeSplit::leaf) {
      nodes_[i] = {TreeSplit::leaf, --leaves};
    } else {
      if (starts.size() < 2) fail();
      starts.pop_back();
      nodes_[i] = {nodes[i], starts.back()};
      starts.pop_back();
    }
    starts.push_back(i);
  }
  if (starts.size() != 1) fail();
}

TreeLeaf LeafFinder::find(Vec2<float> p) const {
  SquareCell c = root_cell(symmetry_);
  std::size_t i = 0;
  while (nodes_[i].split != TreeSplit::leaf) {
    const SquareHalves halves = halves_of(c, nodes_[i].split);
    const bool upper = nodes_[i].split == TreeSplit::x ? p.x >= halves.upper.x0 : p.y >= halves.upper.y0;
    c = upper ? halves.upper : halves.lower;
    i = upper ? nodes_[i].upper_or_leaf : i + 1;
  }
  return {nodes_[i].upper_or_leaf, c};
}

TreeReader::TreeReader(const CanonicalTree& tree, Symmetry symmetry)
    : tree_(tree), symmetry_(symmetry), total_(total_mass(tree)), finder_(tree.nodes, symmetry) {}

double TreeReader::mean_density(const TreeLeaf& leaf) const {
  return tree_.mass[leaf.index] / total_ / share_of(leaf.cell, symmetry_);
}

double TreeReader::density_at(Vec2<float> p) const {
  const TreeLeaf leaf = find(p);
  const SquareCell& c = leaf.cell;
  const double s = 2 * double(p.x - c.x0) / double(c.x1 - c.x0) - 1;
  const double t = 2 * double(p.y - c.y0) / double(c.y1 - c.y0) - 1;
  const double gx = tree_.slope_x[leaf.index] / 128., gy = tree_.slope_y[leaf.index] / 128.;
  return mean_density(leaf) * (1 + gx * s) * (1 + gy * t);
}

}  // namespace reflectree
