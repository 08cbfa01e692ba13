// SPDX-License-Identifier: Apache-2.0
// A way into a sampler, its type erased: one direction at a time, many at once, or batches in lanes.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>

#include "reflectree/math/random.hpp"
#include "reflectree/verify/attack.hpp"

namespace reflectree {

struct DrawnAt {
  Direction wi;
  float pdf = 0;
  bool drawn = false;      // false: "no sample"
  std::uint16_t lane = 0;  // place in a call of batch_lanes directions; no_lane in any other
};
inline constexpr std::size_t batch_lanes = 64;
inline constexpr std::uint16_t no_lane = batch_lanes;

// What a caller may see of exact mode's trials: acceptance by lane, overshoots, and where it gives up.
struct TrialLog {
  struct Lane {
    std::uint64_t trials = 0, accepted = 0;
    double expected = 0, variance = 0;  // of `accepted`: sums of p and p (1 - p), p = min(1, T / (a M))
    // With the lane before: sum of the products of what was accepted less what was expected, its variance.
    double together = 0, together_variance = 0;
  };
  std::array<Lane, batch_lanes + 1> lane;  // the last: trials whose lane is not known
  OvershootSums sums;                      // of T / (a M)
  std::uint64_t exhausted = 0;
  void add(const TrialLog& other);
};

// out.size() directions for wo; weights holds out.size() * channels values.
struct WayIn {
  std::string name;
  bool exact = true;  // density t cos_i / a; else that of one-shot mode's pdf()
  std::function<void(Direction wo, Pcg32& u, std::span<DrawnAt> out, std::span<float> weights)> draw;
  // Exact mode: n directions, with the trials that they took.
  std::function<void(Direction wo, Pcg32& u, std::size_t n, TrialLog& log)> watch;
  // Exact mode: the trials after which it gives up where every acceptance is refused; 0: it did not give up.
  std::function<std::uint64_t(Direction wo)> give_up;
};

}  // namespace reflectree
