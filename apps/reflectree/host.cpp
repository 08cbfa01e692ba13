// SPDX-License-Identifier: Apache-2.0
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <csignal>

#include "context.hpp"
#include "interrupt.hpp"
#include "progress.hpp"
#include "reflectree/error.hpp"

namespace reflectree::cli {

namespace {
volatile std::sig_atomic_t interrupt_flag = 0;
extern "C" void on_interrupt(int) { interrupt_flag = 1; }
}  // namespace

void watch_for_interrupt() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  action.sa_flags = int(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &action, nullptr);
}

bool interrupted() { return interrupt_flag != 0; }

Host Context::host(const std::string& label) const {
  const auto arena =
      std::make_shared<tbb::task_arena>(threads > 0 ? threads : int(tbb::task_arena::automatic));
  Host host;
  // Polled between chunks too, so that work which looks seldom stops soon.
  host.parallel_for = [arena](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    arena->execute([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n),
                        [&](const tbb::blocked_range<std::size_t>& range) {
                          if (interrupted()) throw Cancelled();
                          body(range.begin(), range.end());
                        });
    });
  };
  host.cancelled = interrupted;
  if (!quiet) {
    const auto progress = std::make_shared<Progress>(label);
    host.progress = [progress](float fraction) { progress->show(fraction); };
    host.stage = [progress](const char* words) { progress->stage(words); };
  }
  return host;
}

}  // namespace reflectree::cli
