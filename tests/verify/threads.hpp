// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "reflectree/host.hpp"

namespace reflectree {

// A host with two threads that take one index after the other.
inline Host two_threads() {
  Host host;
  host.parallel_for = [](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    std::atomic<std::size_t> next{0};
    std::exception_ptr failed;
    std::mutex mutex;
    const auto work = [&] {
      try {
        for (std::size_t i = next++; i < n; i = next++) body(i, i + 1);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        failed = std::current_exception();
        next = n;
      }
    };
    std::thread other(work);
    work();
    other.join();
    if (failed) std::rethrow_exception(failed);
  };
  return host;
}

}  // namespace reflectree
