// SPDX-License-Identifier: Apache-2.0
#include "measure.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "reflectree/error.hpp"
#include "reflectree/study/thread_time.hpp"

namespace reflectree::pictures {

using namespace render;
using study::thread_seconds;

namespace {

constexpr std::size_t one_in = 1000;  // pixels is left out of the trimmed mean

RelativeError means_of(std::vector<double> errors) {
  RelativeError e;
  if (errors.empty()) return e;
  std::sort(errors.begin(), errors.end());
  const std::size_t kept = errors.size() - errors.size() / one_in;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    e.all += errors[i] / double(errors.size());
    if (i < kept) e.trimmed += errors[i] / double(kept);
  }
  return e;
}

// square(pixel, channel) / (b^2 + 0.01), a mean over the channels for each pixel that counts.
template <class Square>
std::vector<double> per_pixel(const Image& b, const std::vector<char>& mask, const Square& square) {
  std::vector<double> errors;
  const int channels[] = {b.find("R"), b.find("G"), b.find("B")};
  for (int y = 0; y < b.height; ++y) {
    for (int x = 0; x < b.width; ++x) {
      if (!mask.empty() && !mask[std::size_t(y) * std::size_t(b.width) + std::size_t(x)]) continue;
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double q = double(b.values[b.index(x, y) + std::size_t(channels[k])]);
        sum += square(x, y, k, q) / (q * q + .01) / 3;
      }
      errors.push_back(sum);
    }
  }
  return errors;
}

void render_on(Film& film, const Scene& scene, const Method& method, int samples, std::uint64_t seed,
               const Host& host) {
  RenderOptions how;
  how.samples = samples, how.seed = seed, how.technique = method.technique;
  if (!render_into(film, scene, how, host)) throw Cancelled();
}

}  // namespace

Reference reference_of(const Film& film, std::vector<char> mask) {
  Reference r{to_image(film), {}, std::move(mask)};
  const int errors[] = {r.image.find("stderr.R"), r.image.find("stderr.G"), r.image.find("stderr.B")};
  r.noise = means_of(per_pixel(r.image, r.mask, [&](int x, int y, std::size_t k, double) {
    const double e = double(r.image.values[r.image.index(x, y) + std::size_t(errors[k])]);
    return e * e;
  }));
  return r;
}

RelativeError relative_error(const Image& a, const Reference& b) {
  const int channels[] = {a.find("R"), a.find("G"), a.find("B")};
  RelativeError e = means_of(per_pixel(b.image, b.mask, [&](int x, int y, std::size_t k, double q) {
    const double p = double(a.values[a.index(x, y) + std::size_t(channels[k])]);
    return (p - q) * (p - q);
  }));
  e.all -= b.noise.all, e.trimmed -= b.noise.trimmed;
  return e;
}

Scene prepared(const Scene& scene, const Method& method) {
  Scene s = scene;
  s.transport = method.transport, s.points.kind = method.points;
  return s;
}

double seconds_per_sample(const Scene& scene, const Method& method, const Host& host) {
  const int samples = std::max(1, method.samples / 12);
  double least = 0;
  for (std::uint64_t i = 0; i < 2; ++i) {
    Film film;
    const double start = thread_seconds();
    render_on(film, scene, method, samples, i, host);
    const double took = (thread_seconds() - start) / samples;
    if (i == 0 || took < least) least = took;
  }
  return least;
}

void measure(PictureCell& cell, const Scene& scene, const Method& method, int timed_samples,
             std::uint64_t seed, const Reference& reference, const Host& host, Image* image) {
  Film film;
  double seconds = 0;
  const auto shoot = [&](int samples) {
    const double start = thread_seconds();
    render_on(film, scene, method, samples, seed, host);
    seconds += thread_seconds() - start;
    const Image shown = to_image(film);
    if (image && samples == method.samples) *image = shown;
    return Shot{samples, seconds, relative_error(shown, reference)};
  };
  const bool fewer = timed_samples < method.samples;
  if (fewer) cell.timed = shoot(timed_samples);
  cell.equal = shoot(method.samples);
  if (!fewer) cell.timed = timed_samples == method.samples ? cell.equal : shoot(timed_samples);
}

void for_each_job(unsigned threads, std::size_t n, const std::function<void(std::size_t)>& body) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr fault;
  const auto work = [&] {
    for (std::size_t i = next++; i < n; i = next++) {
      try {
        body(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!fault) fault = std::current_exception();
        next = n;
      }
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned k = 1; k < threads; ++k) others.emplace_back(work);
    work();
  }
  if (fault) std::rethrow_exception(fault);
}

Host with_threads(unsigned threads, Host host) {
  host.parallel_for = [threads](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    for_each_job(threads, n, [&](std::size_t i) { body(i, i + 1); });
  };
  return host;
}

}  // namespace reflectree::pictures
