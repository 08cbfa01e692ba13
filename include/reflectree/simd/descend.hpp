// SPDX-License-Identifier: Apache-2.0
// Several monotone descents side by side, without branches: whether it goes up or down, and when it ends, are
// coin tosses for the predictor, and one descent alone, a chain of loads, leaves most of the machine idle.
#pragma once

#include <bit>

#include "reflectree/math/scalar.hpp"
#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree::detail {

struct Descent {
  const DescentNode* node;
  const PackedLeaf* leaf;
  std::uint32_t leaves;  // of the subtree
  double u[2];           // >= 0: less the lower end of the share that leads here; axis 0 is x
  double size[2];        // of that share

  REFLECTREE_INLINE void start(const PackedForest& forest, const PackedSlab& slab, double u1, double u2) {
    node = forest.nodes.data() + slab.first_node;
    leaf = forest.leaves.data() + slab.first;
    leaves = slab.count;
    u[0] = u1, u[1] = u2;
    size[0] = size[1] = 1;
  }
  // One level down; at a leaf, nothing.
  REFLECTREE_INLINE void step() {
    static constexpr DescentNode end{1, 1, 0};
    const std::uint64_t inside = std::uint64_t(0) - std::uint64_t(leaves > 1);
    const DescentNode& at = leaves > 1 ? *node : end;
    const std::size_t axis = 1 - at.split_x;
    const std::uint32_t below = at.lower_leaves;
    const double lower = size[axis] * double(at.lower), upper = size[axis] - lower;
    const auto lower_bits = std::bit_cast<std::uint64_t>(lower);
    const auto upper_bits = std::bit_cast<std::uint64_t>(upper);
    // u >= lower, for the bits of positive numbers grow with them: all ones or none.
    const auto difference = std::int64_t(std::bit_cast<std::uint64_t>(u[axis]) - lower_bits);
    const std::uint64_t up = ~std::uint64_t(difference >> 63) & inside;
    u[axis] -= std::bit_cast<double>(lower_bits & up);
    size[axis] = std::bit_cast<double>(lower_bits ^ ((lower_bits ^ upper_bits) & up));
    leaf += below & up;
    node += (1 ^ ((1 ^ below) & up)) & inside;
    leaves = below ^ ((below ^ (leaves - below)) & std::uint32_t(up));
  }
  // Where in the leaf, in [0, 1].
  float across(std::size_t axis) const { return min(float(u[axis] / size[axis]), 1.f); }
};

// Down to the leaves.
REFLECTREE_INLINE void descend(Descent* descents, std::size_t n) {
  for (std::uint32_t most = 2; most > 1;) {
    most = 0;
    for (std::size_t k = 0; k < n; ++k) {
      descents[k].step();
      most |= descents[k].leaves;
    }
  }
}

}  // namespace reflectree::detail
