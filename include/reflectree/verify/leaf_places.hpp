// SPDX-License-Identifier: Apache-2.0
// Where in a leaf the directions fall that one-shot mode draws, by each of its ways: bends inside a bin,
// which no chi-square over bins sees. Places are found by point location from the directions alone.
#pragma once

#include <vector>

#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/suspect.hpp"

namespace reflectree {

// For s, t in [-1, 1] across a leaf of slopes gx, gy the density is (1 + gx s)(1 + gy t): E s = gx / 3,
// E s^2 = 1/3, and the CDF in each is uniform. Over all leaves that float directions can resolve:
//   leaf_slope_x, leaf_slope_y   the mean of s - gx / 3 on the side of the slope, in standard deviations
//   leaf_shape                   chi-square of both CDFs over 64 bins, rising and falling slopes apart
//   leaf_distinct                in the leaf that is best resolved: as many distinct places among n as a
//                                fine lattice has; of 16-bit positions there are fewer
// leaf_distinct and most of the draws are of propose(), which draws as sample() does, without f; an eighth is
// drawn by every other way of one-shot mode. Open where no leaf is large enough to be seen.
std::vector<CheckResult> check_leaf_places(const Suspect& suspect, std::uint64_t draws, std::uint64_t seed,
                                           const ChiSquareOptions& options, const Host& host = {});

}  // namespace reflectree
