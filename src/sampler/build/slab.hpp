// SPDX-License-Identifier: Apache-2.0
// A slab of the known coordinates under construction, with its tree over the square.
#pragma once

#include <cstdint>
#include <vector>

#include "leaf.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree::detail {

struct Node {
  TreeSplit split = TreeSplit::leaf;
  std::uint32_t child = 0;  // first of two
  Leaf leaf;
};

struct Slab {
  KnownBox box;
  std::vector<View> views;
  // Landmarks along the slab: they move with wo.
  struct Mark {
    FieldPoint point;
    float albedo;
    Known known;
    Shares travel;  // how far it moves along the slab, along each axis
  };
  std::vector<Mark> marks;
  std::vector<Node> nodes;  // nodes[0] is the root
  SlabPatches patches = {};
  std::size_t attacked = 0;  // nodes whose bounds were attacked; of one-shot trees, whose weights were probed
  float overshoot = 1;       // of exact trees, as last estimated
  float lowered = 0;         // by how much the goal of an exact tree fell, since attacks left it too dear
  // Of one-shot trees: how many times the variance that the grids of the leaves see probes show; 1 at least.
  float shown = 1;
};

// A slab with its views and an unsplit root.
Slab make_slab(const KnownBox& box, const AlbedoTable& albedo, const Field& field);
// Leaves of a slab in preorder (indices into nodes).
std::vector<std::uint32_t> leaves_in_order(const Slab& slab);
// The node of the leaf that holds a point of the square.
std::uint32_t leaf_at(const Slab& slab, Vec2<float> p, const Domain& domain);
// Sum of a member over the leaves.
float total(const Slab& slab, float Leaf::*member);
float total_known_cost(const Slab& slab, int axis);
// Cost and ideal of the leaves together; in exact mode the cost is the volume under the bounds.
struct SlabTotal {
  double cost = 0, ideal = 0;
  // Of one-shot weights, relative.
  double variance() const { return ideal > 0 ? sqr(cost / ideal) - 1 : 0; }
};
SlabTotal total_of(const Slab& slab);
// Of one-shot weights, relative: of the view whose weights vary most. 0 where leaves do not know their views.
double worst_view(const Slab& slab);
// Splits a leaf along its axis; what was seen in it goes to the child that holds the place.
void split_leaf(Slab& slab, std::uint32_t index, const Domain& domain);

}  // namespace reflectree::detail
