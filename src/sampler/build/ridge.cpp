// SPDX-License-Identifier: Apache-2.0
#include "ridge.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/math/frame.hpp"

namespace reflectree::detail {

namespace {

constexpr float nearest = 1e-4f, farthest = 1.5705f;  // theta_o

Direction viewer(float theta) { return {std::sin(theta), 0, std::cos(theta)}; }

// t at directions beside each other, for one wo.
std::vector<float> targets(const AnyBrdf& f, const Target& target, float theta,
                           const std::vector<Direction>& wi) {
  const auto channels = std::size_t(f.channels());
  const std::vector<Direction> wo(wi.size(), viewer(theta));
  std::vector<float> values(wi.size() * channels), t(wi.size());
  f.eval(wo, wi, values);
  for (std::size_t i = 0; i < wi.size(); ++i) t[i] = target(values.data() + i * channels, int(channels));
  return t;
}

Direction beside(Direction w, float a, float b) {
  const LocalFrame<float> frame = frame_from_normal(w);
  return normalize(w + a * frame.s + b * frame.t);
}

struct Top {
  Direction wi;
  float value;
};

// Steps along two tangents, shorter where none helps.
Top climb(const AnyBrdf& f, const Target& target, float theta, Direction start, float step) {
  Top top{start, targets(f, target, theta, {start})[0]};
  for (int round = 0; round < 80 && step > 2e-7f; ++round) {
    std::vector<Direction> around;
    for (int k = 0; k < 8; ++k) {
      const float phi = float(k) * pi / 4;
      around.push_back(beside(top.wi, step * std::cos(phi), step * std::sin(phi)));
    }
    const std::vector<float> t = targets(f, target, theta, around);
    const auto best = std::size_t(std::max_element(t.begin(), t.end()) - t.begin());
    if (t[best] > top.value) {
      top = {around[best], t[best]};
    } else {
      step *= 0.5f;
    }
  }
  return top;
}

// The distance at which t has fallen to a third, the shortest of eight directions.
float width_of(const AnyBrdf& f, const Target& target, float theta, const Top& top) {
  for (float r = 1e-6f; r < 0.5f; r *= 1.25f) {
    std::vector<Direction> around;
    for (int k = 0; k < 8; ++k) {
      const float phi = float(k) * pi / 4;
      around.push_back(beside(top.wi, r * std::cos(phi), r * std::sin(phi)));
    }
    for (const float t : targets(f, target, theta, around)) {
      if (t < 0.33f * top.value) return r;
    }
  }
  return 0.5f;
}

// Where the lobe may be for the next viewer: it stands still, goes with wo, with its mirror image, with the
// half vector, or on as it came.
std::vector<Direction> guesses(float theta, float next, Direction wi, const Direction* previous) {
  const auto turned = [wi](float by) {  // about y, x to z
    const float c = std::cos(by), s = std::sin(by);
    return Direction{wi.x * c + wi.z * s, wi.y, wi.z * c - wi.x * s};
  };
  const Direction wh = normalize(viewer(theta) + wi), wo = viewer(next);
  std::vector<Direction> list{wi, turned(next - theta), turned(theta - next), 2 * dot(wo, wh) * wh - wo};
  if (previous) list.push_back(normalize(2.f * wi - *previous));
  return list;
}

}  // namespace

std::optional<SharpLobe> Ridge::at(float theta) const {
  if (theta_o.empty()) return std::nullopt;
  // Followed to the normal or to the horizon, it goes on to the very end.
  if (theta < theta_o.front()) return theta_o.front() <= nearest ? std::optional(lobe.front()) : std::nullopt;
  if (theta > theta_o.back()) return theta_o.back() >= farthest ? std::optional(lobe.back()) : std::nullopt;
  const auto upper = std::upper_bound(theta_o.begin(), theta_o.end(), theta);
  if (upper == theta_o.end()) return lobe.back();
  const auto k = std::size_t(upper - theta_o.begin());
  const float t = (theta - theta_o[k - 1]) / (theta_o[k] - theta_o[k - 1]);
  return SharpLobe{normalize((1 - t) * lobe[k - 1].centre + t * lobe[k].centre),
                   min(lobe[k - 1].width, lobe[k].width)};
}

Ridge follow_ridge(const AnyBrdf& f, const Target& target, float theta_o, Direction wi) {
  const Top start = climb(f, target, theta_o, wi, 0.01f);
  const float width = width_of(f, target, theta_o, start);
  const float longest =
      min(0.03f, std::sqrt(width));  // so that lines between the places stay inside the lobe
  Ridge ridge{{theta_o}, {{start.wi, width}}};
  for (const float sign : {-1.f, 1.f}) {
    float theta = theta_o, step = min(longest, 2 * width);
    Top top = start;
    Direction previous{};
    bool moved = false;
    for (int round = 0; round < 20'000; ++round) {
      const float next = clamp(theta + sign * step, nearest, farthest);
      if (next == theta) break;
      std::vector<Direction> list = guesses(theta, next, top.wi, moved ? &previous : nullptr);
      for (Direction& w : list) w.z = max(w.z, 1e-6f);
      const std::vector<float> t = targets(f, target, next, list);
      const auto best = std::size_t(std::max_element(t.begin(), t.end()) - t.begin());
      const Top found = climb(f, target, next, list[best], 0.5f * width);
      if (!(found.value > 0.3f * top.value) || !(found.wi.z > 1e-5f)) {
        step *= 0.5f;
        if (step < 0.1f * width || step < 1e-6f) break;
        continue;
      }
      previous = top.wi, moved = true;
      top = found, theta = next;
      const auto at = sign < 0 ? 0 : std::ptrdiff_t(ridge.theta_o.size());
      ridge.theta_o.insert(ridge.theta_o.begin() + at, theta);
      ridge.lobe.insert(ridge.lobe.begin() + at, {top.wi, width});
      step = min(2 * step, longest);
    }
  }
  return ridge;
}

}  // namespace reflectree::detail
