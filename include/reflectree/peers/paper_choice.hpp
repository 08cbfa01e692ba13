// SPDX-License-Identifier: Apache-2.0
// Leaves of the paper's tree: one, or a number of directions divided among all of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "reflectree/math/uniform_bits.hpp"
#include "reflectree/peers/paper_tree.hpp"

namespace reflectree {

// What a node weighs: I, or, retrying from the root, the volume under the bounds.
inline double paper_mass(const PaperNode& node, bool by_volume) {
  return by_volume ? node.volume : node.integral;
}

// A leaf from u and v in [0, 1), which come back uniform and independent of it: they place the first point.
std::size_t choose_paper_leaf(const PaperTree& tree, const PaperOptions& options, double& u, double& v);

// Walker's table of the leaves' masses, after Vose 1991.
std::vector<PaperBucket> make_paper_buckets(const PaperTree& tree, bool by_volume);

// visit(leaf, count): n divided among the children by their CDF, in one traversal. What rounding leaves over
// is placed by one random offset per node, so that each count has the right mean. Allocates nothing.
template <class Visit>
void divide_paper_count(const PaperTree& tree, std::size_t n, UniformBits& u, bool by_volume,
                        const Visit& visit, std::size_t at = 0) {
  if (n == 0) return;
  if (tree.nodes[at].first_child < 0) return visit(at, n);
  const auto first = std::size_t(tree.nodes[at].first_child);
  const double total = paper_mass(tree.nodes[at], by_volume), offset = to_unit_double(u());
  double cumulative = 0;
  std::size_t before = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    cumulative += paper_mass(tree.nodes[first + c], by_volume);
    const double edge = total > 0 ? cumulative / total * double(n) + offset : 0;
    const std::size_t upto = std::max(before, c == 3 ? n : std::min(std::size_t(edge), n));
    divide_paper_count(tree, upto - before, u, by_volume, visit, first + c);
    before = upto;
  }
}

}  // namespace reflectree
