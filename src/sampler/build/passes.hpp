// SPDX-License-Identifier: Apache-2.0
// The trees of both modes, from the first slabs to the last pass.
#pragma once

#include "reflectree/sampler/build.hpp"
#include "slab.hpp"

namespace reflectree::detail {

// Slabs between the elevations at which f has knots or jumps, radians.
std::vector<Slab> first_slabs(const Survey& survey);
// Grows, attacks the bounds, and grows again while the raised bounds cost more trials than allowed. Fills
// expected_trials and overshoot_mass.
std::vector<Slab> build_exact(const Survey& survey, const BuildOptions& options, BuildReport& report);
// Grows and attacks again the slabs that raised bounds made too dear, where there are known coordinates beyond
// theta_o.
void mend_exact(std::vector<Slab>& slabs, const Survey& survey, const BuildOptions& options,
                BuildReport& report);
// Grows, looks between the points of the grids, and grows again where a slab shows more variance than allowed.
std::vector<Slab> build_one_shot(const Survey& survey, const BuildOptions& options);
// Relative, of one-shot weights.
float median_variance(const std::vector<Slab>& slabs);
double worst_variance(const std::vector<Slab>& slabs);
// Of exact trees.
double median_trials(const std::vector<Slab>& slabs);

}  // namespace reflectree::detail
