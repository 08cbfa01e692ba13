// SPDX-License-Identifier: Apache-2.0
#include "phase_clock.hpp"

#include <sys/time.h>

#include <atomic>
#include <csignal>
#include <ctime>

namespace reflectree::cli {

namespace {

constexpr std::size_t phases = std::size_t(render::Phase::count);
std::array<std::atomic<unsigned>, phases> rung;

void ring(int) { rung[std::size_t(render::current_phase)].fetch_add(1, std::memory_order_relaxed); }

void set_timer(long microseconds) {
  const timeval period{0, microseconds};
  const itimerval timer{period, period};
  setitimer(ITIMER_PROF, &timer, nullptr);
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

}  // namespace

PhaseClock::PhaseClock() : start_(cpu_seconds()) {
  for (auto& n : rung) n = 0;
  struct sigaction action {};
  action.sa_handler = ring;
  action.sa_flags = SA_RESTART;
  sigaction(SIGPROF, &action, nullptr);
  set_timer(997);  // microseconds: a prime, to keep out of step with what repeats
}

// The handler stays: a ring may be on its way, and SIGPROF would end the program.
PhaseClock::~PhaseClock() { set_timer(0); }

PhaseClock::Reading PhaseClock::stop() {
  set_timer(0);
  Reading r;
  r.seconds = cpu_seconds() - start_;
  for (const auto& n : rung) r.rings += n;
  for (std::size_t i = 0; i < phases; ++i) r.share[i] = r.rings > 0 ? double(rung[i]) / r.rings : 0;
  return r;
}

}  // namespace reflectree::cli
