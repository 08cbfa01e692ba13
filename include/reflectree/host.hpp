// SPDX-License-Identifier: Apache-2.0
// What the host lends to long work: its threads, a progress display, a way to stop. The core owns
// no thread and no global; results do not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace reflectree {

struct Host {
  // Calls body(begin, end) over disjoint ranges that cover [0, n), in any order, possibly at once.
  std::function<void(std::size_t n, const std::function<void(std::size_t begin, std::size_t end)>& body)>
      parallel_for =
          [](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) { body(0, n); };
  std::function<void(float fraction)> progress = [](float) {};
  // What is done from now on, in a few words: "growing exact trees".
  std::function<void(const char* words)> stage = [](const char*) {};
  std::function<bool()> cancelled = [] { return false; };
};

}  // namespace reflectree
