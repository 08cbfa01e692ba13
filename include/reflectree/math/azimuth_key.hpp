// SPDX-License-Identifier: Apache-2.0
// What stands for an azimuth where only the order counts. A function with a step and the sampler that has a border
// there decide alike, to the last bit, if both compare keys.
#pragma once

#include <cmath>

#include "reflectree/math/scalar.hpp"

namespace reflectree {

// Ascends with the azimuth of (x, y) and takes no arctangent: from 0 to 4 around, equal steps along the square
// |x| + |y| = 1. Of floats or lanes.
template <class T>
REFLECTREE_INLINE T azimuth_key(T x, T y) {
  const T a = abs(x), b = abs(y), q = b / max(a + b, T(1e-37f));
  x = x + T(0), y = y + T(0);  // -0 is 0
  const T upper = by_sign(x, q, T(2) - q);
  return by_sign(y, upper, T(4) - upper);
}

// Of an azimuth in [0, 2 pi], radians; up to 4.
inline float azimuth_key(float phi) {
  if (phi >= 2 * pi) return 4;
  const double x = std::cos(double(phi)), y = std::sin(double(phi));
  const double q = std::abs(y) / (std::abs(x) + std::abs(y)), upper = x < 0 ? 2 - q : q;
  return float(y < 0 ? 4 - upper : upper);
}

}  // namespace reflectree
