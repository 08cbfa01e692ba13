// SPDX-License-Identifier: Apache-2.0
// Several monotone descents side by side: each is a chain of loads and comparisons, and one alone leaves most
// of the machine idle.
#pragma once

#include "reflectree/math/scalar.hpp"
#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree::detail {

struct Descent {
  const DescentNode* node;
  const PackedLeaf* leaf;
  std::uint32_t leaves;  // of the subtree
  double u[2];           // less the lower end of the share that leads here; axis 0 is x
  double size[2];        // of that share

  void start(const PackedForest& forest, const PackedSlab& slab, double u1, double u2) {
    *this = {forest.nodes.data() + slab.first_node,
             forest.leaves.data() + slab.first,
             slab.count,
             {u1, u2},
             {1, 1}};
  }
  REFLECTREE_INLINE void step() {
    const std::size_t axis = 1 - node->split_x;
    const std::uint32_t below = node->lower_leaves;
    const double lower = size[axis] * double(node->lower);
    const bool up = u[axis] >= lower;
    u[axis] -= up ? lower : 0;
    size[axis] = up ? size[axis] - lower : lower;
    leaves = up ? leaves - below : below;
    leaf += up ? below : 0;
    node += up ? below : 1;
  }
  // Where in the leaf, in [0, 1].
  float across(std::size_t axis) const { return min(float(u[axis] / size[axis]), 1.f); }
};

// Down to the leaves.
inline void descend(Descent* descents, std::size_t n) {
  for (bool more = true; more;) {
    more = false;
    for (std::size_t k = 0; k < n; ++k) {
      if (descents[k].leaves > 1) {
        descents[k].step();
        more = true;
      }
    }
  }
}

}  // namespace reflectree::detail
