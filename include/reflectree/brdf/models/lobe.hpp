// SPDX-License-Identifier: Apache-2.0
// cos^n lobes that stay precise when n is large. pow(c, n) multiplies the rounding of c by n; written
// with 1 - c, taken from differences of vectors, the relative error is about sqrt(n) roundings.
#pragma once

#include "reflectree/brdf/shading_geometry.hpp"

namespace reflectree {

// 1 - cos of the angle between two unit vectors.
template <class T>
T versine(Vec3<T> a, Vec3<T> b) {
  const Vec3<T> d = a - b;
  return T(0.5) * dot(d, d);
}

// max(0, cos)^n, given 1 - cos; n > 0.
template <class T>
T cos_power(T one_minus_cos, T n) {
  return exp(n * log1p(-min(one_minus_cos, T(1))));
}

}  // namespace reflectree
