// SPDX-License-Identifier: Apache-2.0
// The limits of the paper's sampler as data: what its trees cost, and how far their estimates of I and M are
// off, by a grid in every leaf that is finer than the one they were made with.
#pragma once

#include <span>

#include "reflectree/host.hpp"
#include "reflectree/peers/paper_tree.hpp"

namespace reflectree {

struct PaperStatistics {
  // Sums over the trees.
  std::size_t leaves = 0, unmet = 0, bytes = 0;
  std::size_t evaluations = 0;  // of f, at precomputation
  // Means over the trees, at their own wo.
  double trials = 0;  // of rejection, for one direction
  double lost = 0;    // share of directions that max_trials end
  // The worst of the trees, relative.
  double integral_error = 0;  // share of the directions that errors of I put into a wrong leaf
  double overshoot = 0;       // share of the target above M: never drawn
  double albedo_error = 0;    // of I_0, and so of pdf and weight
};

// `refine`: how much finer. Trees whose target is zero count for nothing but memory.
PaperStatistics paper_statistics(const AnyBrdf& f, Target target, std::span<const PaperTree> trees,
                                 const PaperOptions& options, int refine = 5, const Host& host = {});

}  // namespace reflectree
