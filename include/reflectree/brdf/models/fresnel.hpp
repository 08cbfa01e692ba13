// SPDX-License-Identifier: Apache-2.0
// Fresnel's equations for unpolarised light (Born & Wolf, Principles of Optics, 1.5 and 14.2),
// and Schlick's approximation.
#pragma once

#include "reflectree/brdf/value.hpp"
#include "reflectree/math/scalar.hpp"

namespace reflectree {

// A dielectric: the mean of both polarisations. n: index of the far side over the near side;
// root = n cos theta_t = sqrt(n^2 - sin^2 theta), 0 where all light is reflected. 0 / 0 where cosine
// and root are 0.
template <class T>
T fresnel_dielectric(T cosine, T root, T n2) {
  const T perpendicular = (cosine - root) / (cosine + root);
  const T parallel = (n2 * cosine - root) / (n2 * cosine + root);
  return T(0.5f) * (sqr(perpendicular) + sqr(parallel));
}

// Light from a vacuum on a metal of index eta + i k.
template <class T>
T fresnel_conductor(T cosine, T eta, T k) {
  const T c2 = cosine * cosine, s2 = T(1) - c2, t0 = eta * eta - k * k - s2;
  const T a2b2 = sqrt(t0 * t0 + T(4) * eta * eta * k * k);
  const T ac = T(2) * sqrt(max((a2b2 + t0) / T(2), T(0))) * cosine;
  const T s = (a2b2 + c2 - ac) / (a2b2 + c2 + ac);
  const T p = s * (c2 * a2b2 + s2 * s2 - ac * s2) / (c2 * a2b2 + s2 * s2 + ac * s2);
  return (s + p) / T(2);
}

// (1 - c)^5 of Schlick's approximation.
template <class T>
T schlick_power(T c) {
  const T m = max(T(1) - c, T(0));
  const T m2 = m * m;
  return m2 * m2 * m;
}

// 1 - (1 - c)^5 = c (1 + m + m^2 + m^3 + m^4), m = 1 - c: precise at grazing, where 1 - schlick_power cancels.
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
