// SPDX-License-Identifier: Apache-2.0
#include "field.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>

#include "reflectree/error.hpp"
#include "reflectree/math/frame.hpp"
#include "refuse.hpp"

namespace reflectree::detail {

namespace {

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
      bool good = is_good(t);
      for (const float v : value) good = good && v >= 0;
      if (!good) refuse_values(value, f.traits().name, geometry[k].wo, geometry[k].wi);
      return t;
    };
    for (std::size_t k = 0; k < count; ++k) {
      const float a = target_of(k * images) * area[k];
      const float b = both_sides ? target_of(k * images + 1) * area[k] : a;
      out[begin + k] = {0.5f * (a + b), max(a, b)};
    }
  }
}

std::vector<Landmark> Field::landmarks(float cos_theta_o) const {
  constexpr float coarse = 1.f / 128;
  const Direction wo = wo_from_cosine(cos_theta_o);
  const auto place = [&](Direction wi) {
    return lower(domain, wo, fold(domain.symmetry, wi));
  };
  std::vector<Landmark> places;
  for (const Direction& wi : {Direction{-wo.x, 0, wo.z}, wo})
    places.push_back({lower(domain, wo, wi), {coarse, coarse}});
  std::vector<SharpLobe> lobes;
  if (f.traits().sharp) lobes = f.traits().sharp(wo);
  for (const Ridge& ridge : ridges) {
    if (const auto lobe = ridge.at(acos(min(cos_theta_o, 1.f)))) lobes.push_back(*lobe);
  }
  for (const SharpLobe& lobe : lobes) {
    if (!(lobe.centre.z > 0) || !(lobe.width > 0)) continue;
    const LocalFrame<float> frame = frame_from_normal(lobe.centre);
    Landmark at{place(lobe.centre), {0, 0}};
    // How far the square's coordinates reach over the lobe, along two directions; azimuths that wrap are far.
    for (const Direction& tangent : {frame.s, frame.t}) {
      const Direction beside = normalize(lobe.centre + min(lobe.width, 0.5f) * tangent);
      if (!(beside.z > 0)) continue;
      const Vec2<float> q = place(beside);
      at.size = {max(at.size.x, abs(q.x - at.p.x)), max(at.size.y, abs(q.y - at.p.y))};
    }
    at.size = {clamp(at.size.x, 0x1p-15f, coarse), clamp(at.size.y, 0x1p-15f, coarse)};
    places.push_back(at);
  }
  return places;
}

bool Survey::at_jump(float cos_theta_o) const {
  if (!jumps || jumps->empty()) return false;
  const float theta = acos(min(cos_theta_o, 1.f));
  return std::any_of(jumps->begin(), jumps->end(), [theta](float jump) {
    return abs(theta - jump) < 4e-6f + 4e-7f / sin(max(jump, 1e-3f));
  });
}

void eval_in_parallel(const Field& field, const Host& host, Effort& effort,
                      std::span<const FieldPoint> points, std::span<FieldValue> out) {
  effort.evaluations += points.size();
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
