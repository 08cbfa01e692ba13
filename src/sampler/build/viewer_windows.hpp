// SPDX-License-Identifier: Apache-2.0
// Groups of neighbouring viewers for which what was drawn disagrees with what was tabulated.
#pragma once

#include <vector>

#include "known_box.hpp"

namespace reflectree::detail {

// A draw for a viewer, and what it says: 1 on average, whoever the viewer is, where trees and albedo are right.
struct ViewerDraw {
  Known known;
  float says;
};

// The boxes of the space, over dyadic grids from the whole to narrow ones, in which the mean of the draws is
// more than 5.5 standard errors off 1: the worst eight, none inside another. Chance alone brings one now and
// then: what is found is suspected, not proved.
std::vector<KnownBox> odd_windows(const std::vector<ViewerDraw>& draws, const KnownBox& space);

}  // namespace reflectree::detail
