// SPDX-License-Identifier: Apache-2.0
// Progress on stderr: a bar on a terminal; elsewhere a plain line at most every second; with what is done
// and, once a tenth of it is, the time left. Work that takes less than half a second shows nothing. The bar
// is wiped when the display goes.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace reflectree::cli {

class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(float fraction);      // from any thread
  void stage(const char* words);  // what is done from now on

 private:
  using Clock = std::chrono::steady_clock;
  std::mutex mutex_;
  std::string label_, stage_;
  bool terminal_, drawn_ = false;
  Clock::time_point start_, last_;
};

}  // namespace reflectree::cli
