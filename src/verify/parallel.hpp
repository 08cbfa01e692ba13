// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/error.hpp"
#include "reflectree/host.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree::detail {

// body(i) for every i in [0, n), on the host's threads where the function allows it.
template <class Body>
void for_each_index(const Host& host, bool concurrent, std::size_t n, const Body& body) {
  const auto range = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (host.cancelled()) throw Cancelled();
      body(i);
    }
  };
  if (concurrent) {
    host.parallel_for(n, range);
  } else {
    range(0, n);
  }
}

// A generator for part `i` of the work of `seed`: both are mixed (SplitMix64, Steele et al. 2014), since
// streams of one seed that differ in the increment alone are related.
inline Pcg32 part_generator(std::uint64_t seed, std::uint64_t i) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15ULL + i * 0xd1342543de82ef95ULL + 0x2545f4914f6cdd1dULL;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return Pcg32(z ^ (z >> 31U), i);
}

// A seed for each of many works.
inline std::uint64_t mixed_seed(std::uint64_t seed, std::uint64_t a, std::uint64_t b = 0) {
  Pcg32 u = part_generator(seed ^ (0x9e3779b97f4a7c15ULL * (b + 1)), a);
  const std::uint64_t high = u();
  return (high << 32U) | u();
}

}  // namespace reflectree::detail
