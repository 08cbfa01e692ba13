// SPDX-License-Identifier: Apache-2.0
// CPU seconds of the calling thread: what a busy machine does beside it does not count.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <ctime>

namespace reflectree::study {

inline double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// Seconds of one call of body(i): the median of seven rounds, each at least `round_seconds` long.
template <class Body>
double median_seconds(double round_seconds, const Body& body) {
  std::array<double, 7> rounds{};
  std::size_t i = 0;
  for (double& mean : rounds) {
    const double start = thread_seconds();
    double took = 0;
    std::size_t calls = 0;
    for (std::size_t chunk = 64; took < round_seconds; chunk *= 2) {
      for (std::size_t k = 0; k < chunk; ++k) body(i++);
      calls += chunk;
      took = thread_seconds() - start;
    }
    mean = took / double(calls);
  }
  std::nth_element(rounds.begin(), rounds.begin() + 3, rounds.end());
  return rounds[3];
}

}  // namespace reflectree::study
