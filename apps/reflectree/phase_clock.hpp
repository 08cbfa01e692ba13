// SPDX-License-Identifier: Apache-2.0
// Where a render's time goes: a timer counts the process's CPU time, and the thread that runs when it rings
// notes what it does. One such clock at a time.
#pragma once

#include <array>

#include "reflectree/render/integrators/profile.hpp"

namespace reflectree::cli {

class PhaseClock {
 public:
  PhaseClock();  // starts
  ~PhaseClock();
  PhaseClock(const PhaseClock&) = delete;
  PhaseClock& operator=(const PhaseClock&) = delete;

  struct Reading {
    double seconds = 0;                                             // of CPU time, all threads
    unsigned rings = 0;                                             // of the timer
    std::array<double, std::size_t(render::Phase::count)> share{};  // by phase; their sum is 1
  };
  Reading stop();

 private:
  double start_;
};

}  // namespace reflectree::cli
