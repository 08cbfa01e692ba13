// SPDX-License-Identifier: Apache-2.0
// A position between ascending nodes, for tables that are linear there.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "reflectree/math/scalar.hpp"

namespace reflectree::detail {

// The node below, the one above, and the fraction of the way to it; below the first and beyond the last
// node, that node. A NaN is below all.
struct BetweenNodes {
  std::size_t low = 0, high = 0;
  float fraction = 0;
};
inline BetweenNodes between_nodes(const std::vector<float>& nodes, float x) {
  if (nodes.size() < 2 || !(x > nodes.front())) return {};
  const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, x);
  const auto high = std::size_t(above - nodes.begin()), low = high - 1;
  return {low, high, min((x - nodes[low]) / (nodes[high] - nodes[low]), 1.f)};
}

}  // namespace reflectree::detail
