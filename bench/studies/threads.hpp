// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <memory>

#include "reflectree/host.hpp"

namespace reflectree::study {

inline Host host_with_threads(int threads) {
  const auto arena = std::make_shared<tbb::task_arena>(threads);
  Host host;
  host.parallel_for = [arena](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    arena->execute([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n),
                        [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); });
    });
  };
  return host;
}

}  // namespace reflectree::study
