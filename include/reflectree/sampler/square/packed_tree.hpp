// SPDX-License-Identifier: Apache-2.0
// A tree as it is sampled: leaves with an alias table, and inner nodes for the monotone descent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reflectree/sampler/square/tree.hpp"

namespace reflectree {

// One leaf: four fill a line of the cache.
struct PackedLeaf {
  std::uint32_t threshold = 0;  // of the alias table's bucket with this index
  float height = 0;             // majorant or density, per share of the square
  std::uint16_t alias = 0;
  // The middle of the cell in 2^-16 of the root square. Its lowest bit is half of the cell's width: cells are
  // halves of halves.
  std::uint16_t x = 0x8000, y = 0x8000;
  std::int8_t slope_x = 0, slope_y = 0;
};
static_assert(sizeof(PackedLeaf) == 16);

// Of a leaf's x or y.
inline std::uint32_t half_width(std::uint32_t middle) { return middle & (0U - middle); }

// The leaf's share of the square.
inline float area_of(const PackedLeaf& leaf) {
  return float(half_width(leaf.x) * half_width(leaf.y)) * 0x1p-30f;
}

struct PackedSlab {
  std::uint32_t first = 0, count = 0;  // leaves
  std::uint32_t first_node = 0;
  std::uint32_t bucket = 0;  // capacity of each bucket of the alias table
  float volume = 0;          // sum of height * area: expected trials, or 1
};

// An inner node of a tree in preorder, without pointers: the subtree of `lower_leaves` leaves below has
// lower_leaves - 1 inner nodes and follows at once; the upper subtree follows that.
struct DescentNode {
  float lower;  // share of the probability
  std::uint32_t lower_leaves : 31, split_x : 1;
};
static_assert(sizeof(DescentNode) == 8);

// The leaves of `tree` in preorder with cells, slopes and the alias table of their masses, heights still 0;
// `mass` becomes what the table holds, a multiple of the count in all. Returns the capacity of each bucket.
std::uint32_t pack_leaves(const CanonicalTree& tree, std::vector<PackedLeaf>& leaves,
                          std::vector<std::uint32_t>& mass);
// Appends the inner nodes of a tree in preorder.
void append_descent(const CanonicalTree& tree, const std::vector<std::uint32_t>& mass,
                    std::vector<DescentNode>& nodes);

namespace detail {

// What a density tree says about a point.
struct Located {
  float density;  // per share of the square
  double u1, u2;  // the uniforms that the monotone descent takes to p
};
// `leaves` and `nodes`: the first of the tree's.
Located locate(const DescentNode* nodes, const PackedLeaf* leaves, std::uint32_t count, Symmetry symmetry,
               Vec2<float> p);

}  // namespace detail
}  // namespace reflectree
