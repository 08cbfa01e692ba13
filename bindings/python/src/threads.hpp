// SPDX-License-Identifier: Apache-2.0
// Threads of one long call, for Host::parallel_for: the core owns none, and a bare machine has no oneTBB.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace reflectree::python {

class Threads {
 public:
  using Body = std::function<void(std::size_t begin, std::size_t end)>;

  // Throws Error where the system does not start as many.
  explicit Threads(unsigned count);
  ~Threads();
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  // body over disjoint ranges that cover [0, n); the caller works, too. A body that calls it again is served
  // by its own thread. The caller's exception is passed on, or else the first.
  void parallel_for(std::size_t n, const Body& body);

 private:
  void end();
  void work();
  void take_ranges(const Body& body, bool is_caller);

  std::mutex mutex_;
  std::condition_variable wake_, done_;
  std::atomic<std::size_t> next_{0};
  const Body* body_ = nullptr;
  std::size_t n_ = 0, step_ = 1, round_ = 0, working_ = 0;
  std::exception_ptr error_;
  bool stop_ = false;
  std::vector<std::thread> helpers_;
};

}  // namespace reflectree::python
