// SPDX-License-Identifier: Apache-2.0
// Square <-> disk <-> hemisphere, each with its inverse and its Jacobian.
//   square: [-1, 1]^2; disk: unit; hemisphere: z >= 0.
#pragma once

#include "reflectree/math/fast_functions.hpp"

namespace reflectree {

// Shirley and Chiu 1997: concentric squares to concentric circles. Area ratio pi / 4 everywhere.
// The half y >= 0 of the square is the half y >= 0 of the disk.
// Written without branches: which triangle of the square p lies in is a coin toss for the predictor.
template <class T>
REFLECTREE_INLINE Vec2<T> square_to_disk(Vec2<T> p) {
  const T ax = abs(p.x), ay = abs(p.y);
  const T radius = ax > ay ? p.x : p.y, across = ax > ay ? p.y : p.x;
  const Vec2<T> c = cos_sin_quarter(across / (radius == T(0) ? T(1) : radius));
  const T along = radius * c.x, aside = radius * c.y;
  return {ax > ay ? along : aside, ax > ay ? aside : along};
}
template <class T>
Vec2<T> disk_to_square(Vec2<T> p) {
  const T radius = sqrt(p.x * p.x + p.y * p.y);
  if (abs(p.x) > abs(p.y)) {
    const T signed_radius = select(p.x < T(0), -radius, radius);
    return {signed_radius, signed_radius * quarter_atan(p.y / p.x)};
  }
  if (p.y == T(0)) return {};
  const T signed_radius = select(p.y < T(0), -radius, radius);
  return {signed_radius * quarter_atan(p.x / p.y), signed_radius};
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
