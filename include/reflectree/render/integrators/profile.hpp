// SPDX-License-Identifier: Apache-2.0
// What a thread that renders is doing, for whoever samples it from outside (a timer's signal): a word of the
// thread's own, so that to say it costs next to nothing and there is no clock in the hot path.
#pragma once

namespace reflectree::render {

enum class Phase : int { rest, traversal, sample, eval, count };

inline constinit thread_local volatile int current_phase = int(Phase::rest);

// Until the end of the scope; then what it was before.
class InPhase {
 public:
  explicit InPhase(Phase phase) : before_(current_phase) { current_phase = int(phase); }
  ~InPhase() { current_phase = before_; }
  InPhase(const InPhase&) = delete;
  InPhase& operator=(const InPhase&) = delete;

 private:
  int before_;
};

}  // namespace reflectree::render
