// SPDX-License-Identifier: Apache-2.0
// Which slab of a partition over theta_o and phi_o holds a viewer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reflectree/sampler/known/partition.hpp"

namespace reflectree {

class SlabTree {
 public:
  SlabTree() = default;
  // Coordinate 0 is theta_o, coordinate 1 phi_o, radians.
  explicit SlabTree(const Partition& partition);
  bool empty() const { return nodes_.empty(); }
  std::size_t operator()(float cos_theta_o, float phi_o) const;
  std::size_t bytes() const { return nodes_.size() * sizeof(Node); }

 private:
  static constexpr std::uint32_t leaf = 2;
  struct Node {
    float split = 0;                                // the cosine of theta_o, or phi_o
    std::uint32_t axis : 2 = leaf, upper : 30 = 0;  // the upper child; of a leaf, its slab
  };
  std::vector<Node> nodes_;  // in preorder
};

}  // namespace reflectree
