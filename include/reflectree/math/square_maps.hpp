// SPDX-License-Identifier: Apache-2.0
// Square <-> disk <-> hemisphere, each with its inverse and its Jacobian.
//   square: [-1, 1]^2; disk: unit; hemisphere: z >= 0.
// No libm trigonometry in float: angles stay in [0, pi/4], where short polynomials are exact to 1e-7.
#pragma once

#include <initializer_list>

#include "reflectree/math/direction.hpp"

namespace reflectree {

namespace detail {
// sin(pi t / 4), cos(pi t / 4) for |t| <= 1; relative error 3e-9 before rounding (Lawson fit).
template <class T>
REFLECTREE_INLINE Vec2<T> cos_sin_quarter(T t) {
  if constexpr (std::is_same_v<T, float>) {
    const float s = t * t;
    return {1.f + s * (-0.308425135f + s * (0.0158543239f + s * (-0.0003259365f + s * 3.52876161e-06f))),
            t * (0.785398161f + s * (-0.0807454325f + s * (0.00249000102f - s * 3.59504522e-05f)))};
  } else {
    return {cos(pi_v<T> / T(4) * t), sin(pi_v<T> / T(4) * t)};
  }
}
// cos(pi t / 2), sin(pi t / 2) for |t| <= 1; error 5e-8 before rounding (Lawson fit).
template <class T>
REFLECTREE_INLINE Vec2<T> cos_sin_half(T t) {
  if constexpr (single_precision<T>) {
    const T h = T(0.5f) * t, s = h * h, s2 = s * s;  // Estrin's scheme: short chains
    return {(T(1.f) - s * T(4.93480214f)) + s2 * ((T(4.05870916f) - s * T(1.33521206f)) +
                                                  s2 * (T(0.234937559f) - s * T(0.0243967166f))),
            h * ((T(3.14159264f) - s * T(5.16771009f)) +
                 s2 * ((T(2.55007766f) - s * T(0.598292159f)) + s2 * T(0.0776594082f)))};
  } else {
    return {cos(pi_v<T> / T(2) * t), sin(pi_v<T> / T(2) * t)};
  }
}
// (4 / pi) atan(t) for |t| <= 1; relative error 1e-7.
template <class T>
T quarter_atan(T t) {
  if constexpr (std::is_same_v<T, float>) {
    const float s = t * t;
    float p = -0.00597563674f;
    for (const float c : {0.0308790214f, -0.0757402948f, 0.126232606f, -0.178501543f, 0.254262416f,
                          -0.424396087f, 1.27323942f}) {
      p = p * s + c;
    }
    return t * p;
  } else {
    return T(4) / pi_v<T> * atan2(t, T(1));
  }
}
}  // namespace detail

// Shirley and Chiu 1997: concentric squares to concentric circles. Area ratio pi / 4 everywhere.
// The half y >= 0 of the square is the half y >= 0 of the disk.
// Written without branches: which triangle of the square p lies in is a coin toss for the predictor.
template <class T>
REFLECTREE_INLINE Vec2<T> square_to_disk(Vec2<T> p) {
  const T ax = abs(p.x), ay = abs(p.y);
  const T radius = ax > ay ? p.x : p.y, across = ax > ay ? p.y : p.x;
  const Vec2<T> c = detail::cos_sin_quarter(across / (radius == T(0) ? T(1) : radius));
  const T along = radius * c.x, aside = radius * c.y;
  return {ax > ay ? along : aside, ax > ay ? aside : along};
}
template <class T>
Vec2<T> disk_to_square(Vec2<T> p) {
  const T radius = sqrt(p.x * p.x + p.y * p.y);
  if (abs(p.x) > abs(p.y)) {
    const T signed_radius = select(p.x < T(0), -radius, radius);
    return {signed_radius, signed_radius * detail::quarter_atan(p.y / p.x)};
  }
  if (p.y == T(0)) return {};
  const T signed_radius = select(p.y < T(0), -radius, radius);
  return {signed_radius * detail::quarter_atan(p.x / p.y), signed_radius};
}
template <class T>
inline constexpr T square_to_disk_jacobian = pi_v<T> / T(4);

// Lambert's azimuthal map: r = sqrt(1 - z). d(solid angle) / d(disk area) = 2.
template <class T>
REFLECTREE_INLINE Vec3<T> disk_to_hemisphere_equal_area(Vec2<T> p) {
  const T r2 = p.x * p.x + p.y * p.y;
  const T s = sqrt(max(T(2) - r2, T(0)));
  return {p.x * s, p.y * s, max(T(1) - r2, T(0))};
}
template <class T>
Vec2<T> hemisphere_to_disk_equal_area(Vec3<T> w) {
  const T s = T(1) / sqrt(T(1) + w.z);
  return {w.x * s, w.y * s};
}
template <class T>
inline constexpr T disk_to_hemisphere_equal_area_jacobian = T(2);

// Orthographic: dx dy = cos theta d(solid angle). d(solid angle) / d(disk area) = 1 / cos theta.
template <class T>
REFLECTREE_INLINE Vec3<T> disk_to_hemisphere_projected(Vec2<T> p) {
  return {p.x, p.y, sqrt(max(T(1) - p.x * p.x - p.y * p.y, T(0)))};
}
template <class T>
constexpr Vec2<T> hemisphere_to_disk_projected(Vec3<T> w) {
  return {w.x, w.y};
}

}  // namespace reflectree
