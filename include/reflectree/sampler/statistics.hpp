// SPDX-License-Identifier: Apache-2.0
// What a caller may count while sampling. Samplers are immutable: the counters belong to the caller.
#pragma once

#include <cstdint>

#include "reflectree/math/scalar.hpp"

namespace reflectree {

struct NoStatistics {
  void trial(bool, float, float) {}
  void exhausted() {}
};

struct SampleStatistics {
  std::uint64_t trials = 0, accepted = 0;
  std::uint64_t overshoots = 0;       // trials with T / a above the leaf's bound
  double overshoot_sum = 0;           // sum of (T / a) / M - 1 over them
  float worst_overshoot = 0;          // largest (T / a) / M - 1
  std::uint64_t exhausted_count = 0;  // "no sample" because the trials ran out

  void trial(bool was_accepted, float ratio, float majorant) {
    ++trials;
    accepted += was_accepted;
    if (ratio > majorant) {
      ++overshoots;
      const float excess = ratio / majorant - 1;
      overshoot_sum += double(excess);
      worst_overshoot = max(worst_overshoot, excess);
    }
  }
  void exhausted() { ++exhausted_count; }
};

}  // namespace reflectree
