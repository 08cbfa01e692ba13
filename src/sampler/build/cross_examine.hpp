// SPDX-License-Identifier: Apache-2.0
// At the end of a build the result is asked by other means than those that built it.
#pragma once

#include "build/albedo/judge_by_trees.hpp"
#include "slab.hpp"

namespace reflectree::detail {

// A direction at which f towers over its bound, or has a value where the albedo says that there is none.
struct Surprise {
  Viewer viewer;
  Direction wi;     // in the viewer's frame
  float ratio;      // of T / albedo to the bound; infinite where the albedo is 0
  Vec2<float> p{};  // the place of wi in the square
};

struct CrossExamination {
  std::vector<Surprise> surprises;  // the largest ratios first
  std::vector<WrongAlbedo> wrong;   // where draws for neighbouring viewers made it suspect; the worst first
  // Means over all viewers of T / albedo, which integrates to 1, drawn from the bounds: as sample_once does,
  // with its standard error, and as sum(V) accepted / trials, which is less where bounds are overshot.
  double by_bounds = 1, by_bounds_error = 0;
  double accepted = 1;
  std::vector<FieldPoint> towers;  // met by the attack
};

// Uniform and domain-drawn probes over the whole partition with the brightest pair that was met before, and
// draws from the trees themselves.
CrossExamination cross_examine(const std::vector<Slab>& slabs, const Survey& survey,
                               const FieldPoint& brightest, std::uint64_t seed);

}  // namespace reflectree::detail
