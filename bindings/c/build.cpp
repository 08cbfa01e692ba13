// SPDX-License-Identifier: Apache-2.0
// Building, saving and loading through the C interface.
#include <atomic>
#include <chrono>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "handles.hpp"
#include "reflectree/formats/sampler_file.hpp"

using namespace reflectree;
using namespace reflectree::c;

namespace {

// Threads that end with the call: [0, n) in pieces, one after the other as threads become free. What one
// throws ends the others' work and is thrown on.
void in_threads(unsigned threads, std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
  const std::size_t piece = std::max<std::size_t>(1, n / (8 * threads));
  std::atomic<std::size_t> next{0};
  std::exception_ptr failed;
  std::mutex mutex;
  const auto work = [&]() noexcept {
    try {
      for (std::size_t i = next.fetch_add(piece); i < n; i = next.fetch_add(piece))
        body(i, std::min(i + piece, n));
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex);
      failed = std::current_exception();
      next = n;
    }
  };
  std::vector<std::thread> others;
  try {
    for (unsigned k = 1; k < threads && k * piece < n; ++k) others.emplace_back(work);
  } catch (...) {
    // As many as the system gives.
  }
  work();
  for (std::thread& other : others) other.join();
  if (failed) std::rethrow_exception(failed);
}

// The caller's `progress` is called by the caller's thread alone, when there is news or 20 ms have passed.
class Progress {
 public:
  Progress(reflectree_progress f, void* user) : f_(f), user_(user) {}
  void show(float fraction) {
    if (fraction > fraction_) fraction_ = fraction, news_ = true;
    tell();
  }
  void stage(const char* words) {
    stage_ = words, news_ = true;
    tell();
  }
  bool cancelled() {
    tell();
    return cancelled_;
  }

 private:
  void tell() {
    if (!f_ || std::this_thread::get_id() != thread_ || cancelled_) return;
    const auto now = std::chrono::steady_clock::now();
    if (!news_ && now - told_ < std::chrono::milliseconds(20)) return;
    news_ = false, told_ = now;
    if (f_(user_, fraction_, stage_.c_str()) != 0) cancelled_ = true;
  }

  reflectree_progress f_;
  void* user_;
  std::thread::id thread_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point told_{};
  float fraction_ = 0;
  std::string stage_ = "starting";
  bool news_ = true;
  std::atomic<bool> cancelled_{false};
};

reflectree_build_options default_options() {
  const BuildOptions o;
  return {.size = sizeof(reflectree_build_options),
          .target = REFLECTREE_NORM,
          .target_channel = 0,
          .expected_trials = o.expected_trials,
          .one_shot_variance = o.one_shot_variance,
          .albedo_error = o.albedo_error,
          .threads = 0,
          .seed = o.seed,
          .max_evaluations = o.max_evaluations,
          .progress = nullptr,
          .progress_user = nullptr};
}

// Callers of later interfaces may know more, none less: this is the first.
void check_size(std::size_t size, const char* where) {
  if (size < sizeof(reflectree_build_options) || size > 65536) {
    refuse(where, "the options' size is " + std::to_string(size),
           "call reflectree_build_options_init(&options, sizeof options)");
  }
}

BuildOptions build_options(const reflectree_build_options& o, const char* where) {
  if (o.target < REFLECTREE_NORM || o.target > REFLECTREE_CHANNEL)
    refuse(where, "target is " + std::to_string(o.target), "pass REFLECTREE_NORM to REFLECTREE_CHANNEL");
  if (o.target_channel < 0 || o.target_channel >= max_channels)
    refuse(where, "target_channel is " + std::to_string(o.target_channel), "count channels from 0");
  if (o.threads < 0 || o.threads > 1024)
    refuse(where, "threads is " + std::to_string(o.threads), "pass 0 to 1024");
  BuildOptions options;
  options.target = {TargetKind(o.target), std::uint16_t(o.target_channel)};
  options.expected_trials = o.expected_trials;
  options.one_shot_variance = o.one_shot_variance;
  options.albedo_error = o.albedo_error;
  options.seed = o.seed;
  options.max_evaluations = o.max_evaluations;
  return options;
}

std::unique_ptr<reflectree_sampler> assembled(const AnyBrdf& f, SamplerData data) {
  auto packed = std::make_shared<const PackedSampler>(pack(data));
  auto s = std::make_unique<reflectree_sampler>(
      reflectree_sampler{.data = std::move(data),
                         .sampler = {ExactSampler<AnyBrdf>(f, packed), OneShotSampler<AnyBrdf>(f, packed)}});
  describe(*s);
  return s;
}

}  // namespace

extern "C" {

reflectree_status reflectree_build_options_init(reflectree_build_options* options, size_t size) {
  return at_border([&] {
    constexpr const char* where = "reflectree_build_options_init";
    needed(options, where, "options");
    check_size(size, where);
    std::memset(options, 0, size);
    const reflectree_build_options defaults = default_options();
    std::memcpy(options, &defaults, sizeof defaults);
    options->size = size;
  });
}

reflectree_status reflectree_build(const reflectree_function* f, const reflectree_build_options* options,
                                   reflectree_sampler** out) {
  return at_border([&] {
    constexpr const char* where = "reflectree_build";
    *needed(out, where, "out") = nullptr;
    const reflectree_function& function = checked(f, where, "f");
    if (options) check_size(options->size, where);
    const reflectree_build_options o = options ? *options : default_options();
    const BuildOptions chosen = build_options(o, where);
    const unsigned threads =
        o.threads > 0 ? unsigned(o.threads) : std::max(1U, std::thread::hardware_concurrency());
    Progress progress(o.progress, o.progress_user);
    Host host;
    host.parallel_for = [threads](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
      in_threads(threads, n, body);
    };
    host.progress = [&progress](float fraction) { progress.show(fraction); };
    host.stage = [&progress](const char* words) { progress.stage(words); };
    host.cancelled = [&progress] { return progress.cancelled(); };
    SamplerData data = build(function.building, chosen, host);
    if (progress.cancelled()) throw Cancelled();
    *out = assembled(function.f, std::move(data)).release();
  });
}

reflectree_status reflectree_save(const reflectree_sampler* s, const char* path) {
  return at_border([&] {
    constexpr const char* where = "reflectree_save";
    save_sampler(needed(path, where, "path"), checked(s, where, "s").data);
  });
}

reflectree_status reflectree_load(const char* path, const reflectree_function* f, const char* data,
                                  reflectree_sampler** out) {
  return at_border([&] {
    constexpr const char* where = "reflectree_load";
    *needed(out, where, "out") = nullptr;
    FilePlaces places;
    if (data) places.data = data;
    const std::string name = needed(path, where, "path");
    if (!f) {
      OpenedSampler opened = open_sampler_file(name, places);
      *out = assembled(opened.f, std::move(opened.data)).release();
      return;
    }
    const reflectree_function& function = checked(f, where, "f");
    SamplerData read = load_sampler(places.find(name));
    check_identity(read, function.f);
    *out = assembled(function.f, std::move(read)).release();
  });
}

void reflectree_sampler_free(reflectree_sampler* s) {
  if (s && s->kind == reflectree_sampler::own_kind) delete s;
}

int reflectree_sampler_channels(const reflectree_sampler* s) {
  return s && s->kind == reflectree_sampler::own_kind ? s->sampler.exact.brdf().channels() : 0;
}
}
