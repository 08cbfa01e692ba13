// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/slab_tree.hpp"

#include <cmath>

namespace reflectree {

SlabTree::SlabTree(const Partition& partition) {
  std::vector<std::uint32_t> open;  // inner nodes whose upper child is still to come
  std::vector<bool> in_lower;
  std::size_t inner = 0;
  std::uint32_t slab = 0;
  for (const std::uint8_t axis : partition.axis) {
    const auto at = std::uint32_t(nodes_.size());
    Node node;
    if (axis == Partition::leaf) {
      node.upper = slab++ & 0x1fffffffU;
      nodes_.push_back(node);
      // The subtree that ends here may be the lower one of its parent, whose upper child follows.
      while (!open.empty() && !in_lower.back()) open.pop_back(), in_lower.pop_back();
      if (open.empty()) break;
      nodes_[open.back()].upper = (at + 1) & 0x1fffffffU;
      in_lower.back() = false;
      continue;
    }
    const float split = partition.split[inner++];
    node.axis = axis & 7U;
    node.split = axis == 0 ? std::cos(split) : split;
    nodes_.push_back(node);
    open.push_back(at), in_lower.push_back(true);
  }
}

std::size_t SlabTree::operator()(float cos_theta_o, float phi_o) const {
  std::uint32_t i = 0;
  while (nodes_[i].axis != leaf) {
    const Node& node = nodes_[i];
    // theta_o grows where its cosine falls; borders belong to the upper slab.
    const bool upper = node.axis == 0 ? cos_theta_o <= node.split : phi_o >= node.split;
    i = upper ? node.upper : i + 1;
  }
  return nodes_[i].upper;
}

std::size_t SlabTree::operator()(float cos_theta_o, const float* others) const {
  std::uint32_t i = 0;
  while (nodes_[i].axis != leaf) {
    const Node& node = nodes_[i];
    const bool upper = node.axis == 0 ? cos_theta_o <= node.split : others[node.axis - 1] >= node.split;
    i = upper ? node.upper : i + 1;
  }
  return nodes_[i].upper;
}

}  // namespace reflectree
