// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "reflectree/math/frame.hpp"

namespace reflectree::detail {

// Where a direction in float may really lie. Rounding displaces wi across its direction and along it. Along
// it is no harm to wi itself, but near grazing, opposite to wo, it tilts the half vector of a function that
// takes wi at its word.
inline std::array<Vec3<double>, 7> neighbours(Direction wi) {
  const Vec3<double> w = normalize(Vec3<double>{wi.x, wi.y, wi.z});
  const LocalFrame<double> frame = frame_from_normal(w);
  constexpr double across = 3e-7, along = 1.2e-7;
  return {w,
          w + across * frame.s,
          w - across * frame.s,
          w + across * frame.t,
          w - across * frame.t,
          (1 + along) * w,
          (1 - along) * w};
}

// The values that something takes over such neighbours.
struct Range {
  double lo = INFINITY, hi = 0;
  void add(double x) { lo = std::fmin(lo, x), hi = std::fmax(hi, x); }
  bool holds(double x, double tolerance) const {
    return x >= lo * (1 - tolerance) && x <= hi * (1 + tolerance);
  }
};

}  // namespace reflectree::detail
