// SPDX-License-Identifier: Apache-2.0
// Growth of a forest: a partition of the known coordinates into slabs and, in each, a tree over the square.
// One engine serves both modes. A leaf has a cost (exact: area * maximum; one-shot: area * root mean square)
// and an ideal (area * mean); a slab is done when sum(cost) <= goal * sum(ideal). Rounds: every leaf of every
// slab that is to be split is evaluated in one batch.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "slab.hpp"

namespace reflectree::detail {

// Beyond 80 degrees.
inline bool is_grazing(const Slab& slab) { return slab.box.lo[0] >= 80 * pi / 180; }

struct GrowthRules {
  float goal;         // sum(cost) / sum(ideal)
  float known_share;  // a slab that narrower ones would save more than this share of (goal - 1) is halved
  std::size_t max_leaves = 60000;
  bool split_slabs = true;
  bool bounds = true;  // shares bound what was seen (exact), or fit it (one-shot)
  std::function<void(Leaf&, Grid, std::span<const View>)> analyse;
  // T / albedo integrates to 1 in every slab. Where a tree that met its goal sees more or less than that, a
  // lobe runs between the points of its grids, and the coarsest leaves are halved until it is met.
  float mass_error = 0.004f;
  float progress = 0, progress_end = 0;  // of the host's bar, where this growth begins and ends
  // Of the effort that is left, what this growth may take.
  float effort_share = 1;
  // No slab is halved where that would leave less effort than so many leaves for every slab that asks for
  // more; and none grows beyond what that effort allows for each. 0: whoever comes first.
  std::size_t leaves_kept = 0;
  // Slabs are done by the mass that they should see, in place of what they see: those that oversee a lobe look for
  // it before their leaves become many.
  bool of_all_mass = false;
  float grazing_goal = 0;  // of grazing slabs; 0: the same
  // A slab below grazing in which the one-shot weights of one view vary by more than this is halved, though the
  // slab as a whole has met its goal. 0: no view is asked.
  float worst_view = 0;
  // After an attack slabs that cost no more than this are done, however far from the goal, and no other may have
  // more than a few times the leaves that it has: what it costs may come of its width. 0: no such mercy.
  float enough = 0;

  float goal_of(const Slab& slab) const {
    const float of_weights = grazing_goal > 0 && is_grazing(slab) ? grazing_goal : goal;
    return slab.shown > 1 ? sqrt(1 + (sqr(of_weights) - 1) / slab.shown) : of_weights - slab.lowered;
  }
};

// Grows until every slab meets the goal, or the effort is spent; a halved slab's halves take its place.
void grow(std::vector<Slab>& slabs, const Survey& survey, const GrowthRules& rules);

}  // namespace reflectree::detail
