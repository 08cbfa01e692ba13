// SPDX-License-Identifier: Apache-2.0
#include "field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <mutex>

#include "reflectree/error.hpp"

namespace reflectree::detail {

namespace {

std::string describe(Direction w) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.7g, %.7g, %.7g)", double(w.x), double(w.y), double(w.z));
  return text;
}

void check(float t, std::span<const float> value, const ShadingGeometry<float>& g, const AnyBrdf& f) {
  bool good = std::isfinite(t) && t >= 0;
  for (const float c : value) good = good && c >= 0;
  if (good) return;
  std::string text;
  for (const float c : value) text += (text.empty() ? "" : ", ") + std::to_string(c);
  throw Error("the BRDF returned [" + text + "]: it must be finite and not negative",
              f.traits().name + " at wo = " + describe(g.wo) + ", wi = " + describe(g.wi),
              "mend the function at these directions");
}

constexpr std::size_t block = 512;  // points evaluated by one call

}  // namespace

void Field::eval(std::span<const FieldPoint> points, std::span<FieldValue> out) const {
  const int channels = f.channels();
  const std::size_t images = both_sides ? 2 : 1;
  std::vector<ShadingGeometry<float>> geometry(block * images);
  std::vector<float> values(geometry.size() * std::size_t(channels)), area(block);
  for (std::size_t begin = 0; begin < points.size(); begin += block) {
    const std::size_t end = std::min(points.size(), begin + block);
    const std::size_t count = end - begin;
    for (std::size_t k = 0; k < count; ++k) {
      const FieldPoint& point = points[begin + k];
      const DomainPoint q = lift(domain, wo_from_cosine(point.cos_theta_o), point.p);
      geometry[k * images] = q.geometry, area[k] = q.projected_area;
      if (!both_sides) continue;
      ShadingGeometry<float>& mirrored = geometry[k * images + 1] = q.geometry;
      mirrored.wi.y = -mirrored.wi.y, mirrored.wh.y = -mirrored.wh.y;
    }
    f.eval({geometry.data(), count * images}, {values.data(), count * images * std::size_t(channels)});
    const auto target_of = [&](std::size_t k) {
      const std::span<const float> value(values.data() + k * std::size_t(channels), std::size_t(channels));
      const float t = target(value.data(), channels);
      check(t, value, geometry[k], f);
      return t;
    };
    for (std::size_t k = 0; k < count; ++k) {
      const float a = target_of(k * images) * area[k];
      const float b = both_sides ? target_of(k * images + 1) * area[k] : a;
      out[begin + k] = {0.5f * (a + b), max(a, b)};
    }
  }
}

void eval_in_parallel(const Field& field, const Host& host, std::span<const FieldPoint> points,
                      std::span<FieldValue> out) {
  if (host.cancelled()) throw Cancelled();
  if (!field.f.traits().concurrent) return field.eval(points, out);
  // The error of the lowest block wins, so that the message does not depend on the threads.
  std::mutex mutex;
  std::size_t first_bad = points.size();
  std::exception_ptr error;
  const std::size_t blocks = (points.size() + block - 1) / block;
  host.parallel_for(blocks, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t from = b * block, count = std::min(block, points.size() - from);
      try {
        field.eval(points.subspan(from, count), out.subspan(from, count));
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (b < first_bad) first_bad = b, error = std::current_exception();
      }
    }
  });
  if (error) std::rethrow_exception(error);
}

}  // namespace reflectree::detail
