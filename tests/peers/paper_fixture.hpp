// SPDX-License-Identifier: Apache-2.0
// What the tests of the paper's tree and of its sampler share.
#pragma once

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/peers/paper_choice.hpp"

namespace reflectree {

inline AnyBrdf brdf(const char* text) { return make_brdf(parse_material(text)); }
inline Direction at(double theta_deg) {
  return direction_from_angles(float(theta_deg * pi_v<double> / 180), 0.f);
}

// A leaf that takes more than its share.
inline PaperTree spoiled(PaperTree tree, const PaperOptions& options) {
  std::size_t heaviest = 0;
  for (std::size_t i = 1; i < tree.nodes.size(); ++i) {
    if (tree.nodes[i].first_child >= 0) continue;
    if (heaviest == 0 || tree.nodes[i].integral > tree.nodes[heaviest].integral) heaviest = i;
  }
  tree.nodes[heaviest].integral *= 1.6, tree.nodes[heaviest].volume *= 1.6;
  if (!tree.buckets.empty()) tree.buckets = make_paper_buckets(tree, options.retry_from_root);
  return tree;
}

}  // namespace reflectree
