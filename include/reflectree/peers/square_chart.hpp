// SPDX-License-Identifier: Apache-2.0
// Two charts of the directions wi by the unit square, for methods that tabulate: x is an elevation, y an
// azimuth relative to that of wo, over the whole circle. wo lies in the plane y = 0.
#pragma once

#include <cstdint>

#include "reflectree/math/direction.hpp"

namespace reflectree {

// hemisphere: equal area about the normal, cos theta_i = 1 - x. half_vector: theta_h = pi/2 x^2, graded
// towards the normal as in Dupuy and Jakob 2018; a lobe stays put while wo moves, but a part of the square
// reflects below the horizon.
enum class SquareChart : std::uint8_t { hemisphere, half_vector };

struct ChartPoint {
  Direction wi;
  float jacobian;  // d(solid angle of wi) / (dx dy); 0 where wo cannot be reflected
};
inline ChartPoint chart_point(SquareChart chart, Direction wo, Vec2<float> p) {
  const float phi = 2 * pi * (p.y - 0.5f), c = cos(phi), s = sin(phi);
  if (chart == SquareChart::hemisphere) {
    const float z = 1 - p.x, r = sqrt(max(p.x * (2 - p.x), 0.f));
    return {{r * c, r * s, z}, 2 * pi};
  }
  const float theta = 0.5f * pi * p.x * p.x, sin_h = sin(theta);
  const Direction wh{sin_h * c, sin_h * s, cos(theta)};
  const float cos_d = dot(wo, wh);
  return {reflect(wo, wh), max(8 * pi * pi * p.x * sin_h * cos_d, 0.f)};
}

struct ChartPlace {
  Vec2<float> p;
  float jacobian;
};
inline ChartPlace chart_place(SquareChart chart, Direction wo, Direction wi) {
  const Direction w = chart == SquareChart::hemisphere ? wi : normalize(wo + wi);
  const float y = phi_of(w) * (0.5f / pi) + 0.5f;
  // 1 - z loses the digits near the pole
  if (chart == SquareChart::hemisphere) return {{(w.x * w.x + w.y * w.y) / (1 + w.z), y}, 2 * pi};
  // At the normal itself the Jacobian is zero: a density there is that of a point 2e-8 away.
  const float x = min(max(sqrt(theta_of(w) * (2 / pi)), 1e-4f), 1.f);
  const float sin_h = max(sqrt(w.x * w.x + w.y * w.y), 0.5e-8f * pi);
  return {{x, y}, max(8 * pi * pi * x * sin_h * dot(wo, w), 0.f)};
}

// The frame in which wo lies in the half-plane y = 0, x >= 0.
struct AzimuthFrame {
  float c = 1, s = 0, sin_theta = 0;
  explicit AzimuthFrame(Direction wo) : sin_theta(sqrt(wo.x * wo.x + wo.y * wo.y)) {
    if (sin_theta > 0) c = wo.x / sin_theta, s = wo.y / sin_theta;
  }
  Direction to_local(Direction w) const { return {c * w.x + s * w.y, c * w.y - s * w.x, w.z}; }
  Direction to_world(Direction w) const { return {c * w.x - s * w.y, s * w.x + c * w.y, w.z}; }
};

}  // namespace reflectree
