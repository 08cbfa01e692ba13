// SPDX-License-Identifier: Apache-2.0
// A slab of theta_o under construction, with its tree over the square.
#pragma once

#include <cstdint>
#include <vector>

#include "leaf.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree::detail {

inline constexpr float theta_max = 1.5707887f;  // cos = min_cos_theta_o, rounded outwards

struct Node {
  TreeSplit split = TreeSplit::leaf;
  std::uint32_t child = 0;  // first of two
  Leaf leaf;
};

struct Slab {
  float theta_lo, theta_hi;
  std::vector<View> views;
  // Landmarks along the slab: they move with theta_o.
  struct Mark {
    FieldPoint point;
    float albedo, theta;
    float travel;  // how far it moves along the slab
  };
  std::vector<Mark> marks;
  std::vector<Node> nodes;  // nodes[0] is the root
};

// A slab with its views and an unsplit root.
Slab make_slab(float theta_lo, float theta_hi, const AlbedoTable& albedo, const Field& field);
// Leaves of a slab in preorder (indices into nodes).
std::vector<std::uint32_t> leaves_in_order(const Slab& slab);
// Sum of a member over the leaves.
float total(const Slab& slab, float Leaf::*member);
// Cost and ideal of the leaves together; in exact mode the cost is the volume under the bounds.
struct SlabTotal {
  double cost = 0, ideal = 0;
  // Of one-shot weights, relative.
  double variance() const { return ideal > 0 ? sqr(cost / ideal) - 1 : 0; }
};
SlabTotal total_of(const Slab& slab);
// Splits a leaf along its axis; what was seen in it goes to the child that holds the place.
void split_leaf(Slab& slab, std::uint32_t index, const Domain& domain);

}  // namespace reflectree::detail
