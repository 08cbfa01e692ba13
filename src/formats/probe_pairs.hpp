// SPDX-License-Identifier: Apache-2.0
// Random pairs of directions, half of them near the mirror direction, at which a file is asked how sound
// its values are.
#pragma once

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/formats/measured_facts.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {

enum class PairVerdict { sound, clipped, bridged, dark };

struct RandomPair {
  ShadingGeometry<float> geometry;
  std::size_t band;  // of the larger elevation, in MeasuredFacts::bands_deg
};
// The number of pairs, and the next of them that is above the surface.
inline constexpr std::uint64_t probed_pairs = 20000;
RandomPair next_pair(Pcg32& random, std::uint64_t number);

// Asks judge(geometry, channel) of every pair.
template <class Judge>
void probe_pairs(MeasuredFacts& facts, const Judge& judge) {
  Pcg32 random(38);
  while (facts.pairs < probed_pairs) {
    const RandomPair pair = next_pair(random, facts.pairs);
    bool touched = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const PairVerdict verdict = judge(pair.geometry, int(c));
      touched = touched || verdict != PairVerdict::sound;
      if (verdict == PairVerdict::clipped) ++facts.clipped[c];
      if (verdict == PairVerdict::bridged) ++facts.bridged[c];
      if (verdict == PairVerdict::dark) ++facts.dark[c];
    }
    ++facts.pairs, ++facts.pairs_in_band[pair.band];
    if (touched) ++facts.touched_in_band[pair.band];
  }
}

}  // namespace reflectree
