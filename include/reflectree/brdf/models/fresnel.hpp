// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/value.hpp"
#include "reflectree/math/scalar.hpp"

namespace reflectree {

// (1 - c)^5 of Schlick's approximation.
template <class T>
T schlick_power(T c) {
  const T m = max(T(1) - c, T(0));
  const T m2 = m * m;
  return m2 * m2 * m;
}

// 1 - (1 - c)^5 = c (1 + m + m^2 + m^3 + m^4), m = 1 - c: precise at grazing, where 1 - schlick_power
// cancels.
template <class T>
T schlick_complement(T c) {
  const T m = max(T(1) - c, T(0));
  return c * (T(1) + m * (T(1) + m * (T(1) + m * (T(1) + m))));
}

// F_schlick = f0 + (1 - f0)(1 - cos theta_d)^5. Schlick 1994, eq. 15.
template <class T>
RgbT<T> fresnel_schlick(Rgb f0, T cos_theta_d) {
  const T m5 = schlick_power(cos_theta_d);
  const auto lifted = [m5](float c) { return T(c) + (T(1) - T(c)) * m5; };
  return {lifted(f0.r), lifted(f0.g), lifted(f0.b)};
}

}  // namespace reflectree
