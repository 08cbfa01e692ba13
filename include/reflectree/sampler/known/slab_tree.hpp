// SPDX-License-Identifier: Apache-2.0
// Which slab of a partition over several known coordinates holds a viewer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reflectree/sampler/known/partition.hpp"

namespace reflectree {

class SlabTree {
 public:
  SlabTree() = default;
  // Coordinate 0 is theta_o; phi_o, radians, where it is known, coordinate 1; parameters follow.
  explicit SlabTree(const Partition& partition);
  bool empty() const { return nodes_.empty(); }
  std::size_t operator()(float cos_theta_o, float phi_o) const;
  // Of families; others: all coordinates but theta_o, by their place in the partition from 1 on.
  std::size_t operator()(float cos_theta_o, const float* others) const;
  std::size_t bytes() const { return nodes_.size() * sizeof(Node); }

 private:
  static constexpr std::uint32_t leaf = 7;
  struct Node {
    float split = 0;                                // the cosine of theta_o, or another coordinate
    std::uint32_t axis : 3 = leaf, upper : 29 = 0;  // the upper child; of a leaf, its slab
  };
  std::vector<Node> nodes_;  // in preorder
};

}  // namespace reflectree
