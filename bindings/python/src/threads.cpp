// SPDX-License-Identifier: Apache-2.0
#include "threads.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "reflectree/error.hpp"

namespace reflectree::python {

namespace {
thread_local bool inside = false;  // of some parallel_for
}  // namespace

Threads::Threads(unsigned count) {
  try {
    for (unsigned i = 1; i < count; ++i) helpers_.emplace_back([this] { work(); });
  } catch (const std::system_error&) {  // a thread that is not joined would end the process
    end();
    throw Error(
        "the system starts only " + std::to_string(helpers_.size() + 1) + " of " + std::to_string(count),
        "threads", "ask for fewer");
  }
}

Threads::~Threads() { end(); }

void Threads::end() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void Threads::take_ranges(const Body& body, bool is_caller) {
  inside = true;
  try {
    for (std::size_t begin; (begin = next_.fetch_add(step_)) < n_;) body(begin, std::min(n_, begin + step_));
  } catch (...) {
    const std::lock_guard lock(mutex_);
    if (is_caller || !error_) error_ = std::current_exception();
    next_ = n_;
  }
  inside = false;
}

void Threads::work() {
  std::unique_lock lock(mutex_);
  for (std::size_t seen = 0;;) {
    // Who wakes up too late for a round has missed it; nobody waits for sleepers.
    wake_.wait(lock, [&] { return stop_ || (body_ && round_ != seen); });
    if (stop_) return;
    seen = round_;
    ++working_;
    const Body& body = *body_;
    lock.unlock();
    take_ranges(body, false);
    lock.lock();
    if (--working_ == 0) done_.notify_one();
  }
}

void Threads::parallel_for(std::size_t n, const Body& body) {
  if (n <= 1 || inside || helpers_.empty()) {
    if (n > 0) body(0, n);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    body_ = &body, n_ = n, next_ = 0, error_ = nullptr;
    step_ = std::max<std::size_t>(1, n / (8 * (helpers_.size() + 1)));
    ++round_;
  }
  wake_.notify_all();
  take_ranges(body, true);
  std::unique_lock lock(mutex_);
  body_ = nullptr;
  done_.wait(lock, [&] { return working_ == 0; });
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

}  // namespace reflectree::python
