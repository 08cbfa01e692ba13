// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "reflectree/math/direction.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {

// What may go wrong in batches: more than one block, neighbours that share wo, pairs below the surface.
struct RunsOfPairs {
  std::vector<Direction> wo, wi;
};
inline RunsOfPairs runs_of_pairs() {
  RunsOfPairs pairs;
  Pcg32 u(8);
  for (int i = 0; i < 301; ++i) {
    const auto any = [&u] {
      return direction_from_angles(1.8f * to_unit_float(u()), 6 * to_unit_float(u()));
    };
    pairs.wo.push_back(i % 3 == 1 ? pairs.wo.back() : any()), pairs.wi.push_back(any());
  }
  return pairs;
}

}  // namespace reflectree
