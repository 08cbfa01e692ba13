// SPDX-License-Identifier: Apache-2.0
// Pairs of directions as a user gives them: vectors or angles in the arguments, or a table.
#pragma once

#include <string>
#include <vector>

#include "reflectree/math/direction.hpp"

namespace reflectree::cli {

struct PairWords {
  std::vector<std::string> wo, wi;                // "X,Y,Z"
  std::string theta_o_deg, theta_i_deg, phi_deg;  // "A,A,..."
  std::string table;                              // a CSV file; "-": stdin
};

struct DirectionPairs {
  std::vector<Direction> wo, wi;
};

// A vector may be 0.001 too long or too short, as rounding in text makes it, and is normalised. Of two lists
// in the arguments, one may hold a single entry for all of the other's. Throws Error, naming line and column
// or the argument, for what is no pair of unit vectors above the surface.
DirectionPairs read_pairs(const PairWords& words);

}  // namespace reflectree::cli
