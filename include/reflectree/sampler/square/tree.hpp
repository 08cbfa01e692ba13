// SPDX-License-Identifier: Apache-2.0
// A tree over the square of a domain in its canonical form, and the one way to read it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "reflectree/sampler/square/symmetry.hpp"

namespace reflectree {

// A node of a tree over the square, in preorder; the lower half comes first.
enum class TreeSplit : std::uint8_t { leaf = 0, x = 1, y = 2 };

// A tree of one slab. Leaf i is chosen with probability mass_i / sum(mass); across it, for s, t in [-1, 1],
// runs the product-linear shape q = (1 + gx s)(1 + gy t), gx = slope_x / 128 in (-1, 1), whose mean is 1.
struct CanonicalTree {
  std::vector<TreeSplit> nodes;
  std::vector<std::uint32_t> mass;  // of each leaf, in preorder
  std::vector<std::int8_t> slope_x, slope_y;
  friend bool operator==(const CanonicalTree&, const CanonicalTree&) = default;
};

// Throws Error, naming `where`, unless the tree is complete, at most 15 levels deep per axis, and has one
// mass that is not 0 and two slopes per leaf.
void validate(const CanonicalTree& tree, const std::string& where);

double total_mass(const CanonicalTree& tree);

// Both halves of a cell.
struct SquareHalves {
  SquareCell lower, upper;
};
SquareHalves halves_of(const SquareCell& cell, TreeSplit split);

// visit(split, cell) of every node in preorder. The tree is complete.
template <class Visit>
void for_each_node(const std::vector<TreeSplit>& nodes, Symmetry symmetry, Visit&& visit) {
  std::vector<SquareCell> stack{root_cell(symmetry)};
  for (const TreeSplit split : nodes) {
    if (stack.empty()) return;
    const SquareCell cell = stack.back();
    stack.pop_back();
    visit(split, cell);
    if (split == TreeSplit::leaf) continue;
    const SquareHalves halves = halves_of(cell, split);
    stack.push_back(halves.upper);
    stack.push_back(halves.lower);
  }
}
// The cells of all leaves, in preorder.
std::vector<SquareCell> leaf_cells(const std::vector<TreeSplit>& nodes, Symmetry symmetry);

// A leaf of a tree: its index in preorder, and its cell.
struct TreeLeaf {
  std::size_t index = 0;
  SquareCell cell{};
};

// Finds the leaf that holds a point of the square.
class LeafFinder {
 public:
  // Throws Error unless the tree is complete.
  LeafFinder(const std::vector<TreeSplit>& nodes, Symmetry symmetry);
  // The leaf with x0 <= p.x < x1 and y0 <= p.y < y1; points on the outer edges are inside.
  TreeLeaf find(Vec2<float> p) const;

 private:
  struct Node {
    TreeSplit split = TreeSplit::leaf;
    std::size_t upper_or_leaf = 0;  // the upper child, or the leaf's index
  };
  Symmetry symmetry_;
  std::vector<Node> nodes_;
};

// What a tree says about a point. Holds a reference to it.
class TreeReader {
 public:
  // Throws Error unless the tree is complete.
  TreeReader(const CanonicalTree& tree, Symmetry symmetry);

  TreeLeaf find(Vec2<float> p) const { return finder_.find(p); }
  // Per share of the square: mass_i / sum(mass) / share_i, and with the shape across the leaf. The volume of
  // a majorant tree times it is its bound.
  double mean_density(const TreeLeaf& leaf) const;
  double density_at(Vec2<float> p) const;

 private:
  const CanonicalTree& tree_;
  Symmetry symmetry_;
  double total_;
  LeafFinder finder_;
};

}  // namespace reflectree
