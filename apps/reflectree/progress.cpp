// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>

namespace reflectree::cli {

namespace {
constexpr int bar_width = 30;
}

Progress::Progress(std::string label)
    : label_(std::move(label)), terminal_(isatty(STDERR_FILENO) == 1), start_(Clock::now()), last_(start_) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\x1b[K"), std::fflush(stderr);
}

void Progress::stage(const char* words) {
  const std::lock_guard lock(mutex_);
  stage_ = std::string(", ") + words;
}

void Progress::show(float fraction) {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  const auto pause = std::chrono::milliseconds(!terminal_ ? 1000 : drawn_ ? 100 : 500);
  if (now - last_ < pause) return;
  last_ = now;
  const float share = std::clamp(fraction, 0.f, 1.f);
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const std::string left =
      share >= .1f ? fmt::format(", {:.0f} s left", elapsed * (1 / double(share) - 1)) : std::string();
  if (terminal_) {
    const auto full = std::size_t(share * bar_width);
    fmt::print(stderr, "\r{} [{}{}] {:3.0f} %{}{}\x1b[K", label_, std::string(full, '#'),
               std::string(bar_width - full, '.'), double(share) * 100, left, stage_);
    drawn_ = true;
  } else {
    fmt::print(stderr, "{}: {:.0f} %{}{}\n", label_, double(share) * 100, left, stage_);
  }
  std::fflush(stderr);
}

}  // namespace reflectree::cli
