// SPDX-License-Identifier: Apache-2.0
// What a way into a sampler drew for one wo: bins, channels and lanes. Weights are reduced
// by the referee's own target.
#pragma once

#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/suspect.hpp"

namespace reflectree {

inline constexpr std::size_t lane_groups = 16;  // of neighbouring bins, in which lanes are compared

struct WayTally : Tally {
  std::vector<double> channel, channel2;  // sums of each channel's weight and of its square
  std::vector<std::uint64_t> lane_count;  // batch_lanes * lane_groups
  std::uint64_t dead_lit = 0;             // weight 0 where f is not 0
};
WayTally tally_of(const Suspect& suspect, const WayIn& way, const Bins& bins, std::uint64_t samples,
                  std::uint64_t seed, const Host& host = {});

// Every channel's mean weight is its own integral of f cos_i. A reference is the integral of a combination
// of channels: one for each where there are few, random ones where there are many.
struct ChannelReference {
  std::vector<double> coefficients;
  CubatureResult integral;
};
std::vector<ChannelReference> channel_references(const AnyBrdf& f, Direction wo, std::uint64_t seed,
                                                 const Host& host = {});
// The worst of them, in standard errors at the level of options; `tolerance` relative beside.
CheckResult check_channel_weights(const WayTally& tally, std::span<const ChannelReference> references,
                                  const ChiSquareOptions& options, double tolerance = 1e-4);

// Each lane of a batch draws as all of them do: the worst lane's chi-square over lane_groups.
CheckResult check_lanes(const WayTally& tally, const ChiSquareOptions& options);

// "No sample", below the horizon, not finite, weight 0 where f is not 0: each is one too many. Directions of
// weight 0 where f is 0 are no fault of a mode that draws without f (decision 0018): counted and told. In
// exact mode weight 0 is a fault. expected_none: where trials may run out, how often they should.
CheckResult check_alive(const WayTally& tally, bool exact, double expected_none = 0);

}  // namespace reflectree
