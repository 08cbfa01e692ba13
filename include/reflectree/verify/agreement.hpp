// SPDX-License-Identifier: Apache-2.0
// Direction by direction: what a way in returns agrees with f, with the densities and with itself. Needs no
// integral and few draws, so it can visit many elevations: a fault that begins at one border of a slab shows.
#pragma once

#include <vector>

#include "reflectree/verify/result.hpp"
#include "reflectree/verify/suspect.hpp"

namespace reflectree {

struct AgreementOptions {
  int draws = 60;  // per viewer and way
  std::uint64_t seed = 1;
  double tolerance = 1e-4;       // relative
  double max_exceptions = 1e-3;  // share of all draws outside of it: float borders of leaves
  double max_share = 0.15;       // share at one viewer
};

// A direction in float has an error of about 6e-8, which sharp lobes and the borders of leaves magnify; a
// value agrees where it lies within the tolerance of the range that the other takes over such neighbours.
//   finite           every direction, pdf and weight
//   pdf_agrees       pdf == pdf(wo, wi)
//   weight_agrees    weight * pdf == f cos_i, channel by channel
//   support          where f is not 0, neither is the other mode's density
//   target           exact mode: the target of the weight is the albedo, whatever the direction
//   mode_agrees      exact mode: pdf == t cos_i / albedo by the referee's own target
// One result per kind and way.
std::vector<CheckResult> check_agreement(const Suspect& suspect, std::span<const Direction> viewers,
                                         const AgreementOptions& options = {}, const Host& host = {});

// Each of the two uniforms that invert() gives for a direction brings it back: worst of many, within float.
CheckResult check_round_trip(const Suspect& suspect, std::span<const Direction> viewers,
                             const AgreementOptions& options = {}, const Host& host = {});

}  // namespace reflectree
