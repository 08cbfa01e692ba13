// SPDX-License-Identifier: Apache-2.0
#include "host.hpp"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "threads.hpp"

namespace reflectree::python {

namespace nb = nanobind;

namespace {

using Clock = std::chrono::steady_clock;

struct Told {
  explicit Told(unsigned count) : threads(count) {}
  ~Told() {
    const nb::gil_scoped_acquire gil;
    progress.reset();
  }
  Threads threads;
  nb::object progress;
  std::string stage;
  std::atomic<float> fraction{0};  // helpers tell it, too
  std::thread::id caller = std::this_thread::get_id();
  Clock::time_point looked = Clock::now(), shown = {};
  std::atomic<bool> stopped{false};  // helpers see it

  bool is_caller() const { return std::this_thread::get_id() == caller; }
  void show(bool now) {
    if (!is_caller() || progress.is_none()) return;
    if (!now && Clock::now() - shown < std::chrono::milliseconds(50)) return;
    shown = Clock::now();
    const nb::gil_scoped_acquire gil;
    call_or_stop([&] { progress(fraction.load(), stage); });
  }
  // Python runs the handlers of signals in its main thread alone.
  bool cancelled() {
    if (stopped || !is_caller()) return stopped;
    if (Clock::now() - looked < std::chrono::milliseconds(20)) return false;
    looked = Clock::now();
    const nb::gil_scoped_acquire gil;
    call_or_stop([] {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
    });
    return false;
  }
  template <class Call>
  void call_or_stop(const Call& call) {
    try {
      call();
    } catch (...) {
      stopped = true;
      throw;
    }
  }
};

}  // namespace

Host make_host(unsigned threads, nb::object progress) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  const auto told = std::make_shared<Told>(threads);
  told->progress = std::move(progress);
  Host host;
  host.parallel_for = [told](std::size_t n, const Threads::Body& body) {
    told->threads.parallel_for(n, body);
  };
  host.progress = [told](float fraction) {
    told->fraction = fraction;
    told->show(fraction >= 1);
  };
  host.stage = [told](const char* words) {
    if (told->is_caller()) told->stage = words;
    told->show(true);
  };
  host.cancelled = [told] { return told->cancelled(); };
  return host;
}

}  // namespace reflectree::python
