// SPDX-License-Identifier: Apache-2.0
// Exact mode's rejection, watched: how often it accepts, what its bounds miss, and where it gives up.
#pragma once

#include "reflectree/verify/attack.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/suspect.hpp"

namespace reflectree {

// `directions` for random wo (all azimuths; elevations uniform up to 89.9 degrees) by one way of exact mode.
TrialLog watch_trials(const Suspect& suspect, const WayIn& way, std::uint64_t directions, std::uint64_t seed,
                      const Host& host = {});

// A trial is accepted with probability T / (a M), in every lane: accepted less the sum of these, in standard
// deviations; and whatever the lane before does: the sum of the products of both. The worst lane decides.
CheckResult check_acceptance(const std::string& way, const TrialLog& log, const ChiSquareOptions& options);

// Where every acceptance is refused, a draw ends after as many trials as are promised and not before, since
// a sampler that gives up early bends its density by what it leaves out (decision 0009).
CheckResult check_giving_up(const WayIn& way, std::uint64_t promised = 256);

// T / (a M) of the function to its bound anywhere, by point location in the canonical trees: what an attack
// maximises. Keeps a reference to the data.
RatioFunction bound_ratio(AnyBrdf f, const SamplerData& data);
// Of all members of a family: parameters are coordinates, too.
RatioFunction bound_ratio(AnyFamily family, const SamplerData& data);
// How many coordinates a point has that attacks the bounds of a sampler.
int attack_coordinates(const SamplerData& data);

}  // namespace reflectree
