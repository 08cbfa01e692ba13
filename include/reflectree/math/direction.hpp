// SPDX-License-Identifier: Apache-2.0
// Vectors and directions. A Direction is a unit vector in the local frame of the surface: z is the
// normal, cos theta = z (signed), sin theta cos phi = x, sin theta sin phi = y.
#pragma once

#include "reflectree/math/scalar.hpp"

namespace reflectree {

template <class T>
struct Vec2 {
  T x{}, y{};
  friend constexpr bool operator==(const Vec2&, const Vec2&) = default;
};

template <class T>
struct Vec3 {
  T x{}, y{}, z{};
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(T s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
};

using Direction = Vec3<float>;

template <class T>
constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T length(Vec3<T> a) {
  return sqrt(dot(a, a));
}
template <class T>
Vec3<T> normalize(Vec3<T> a) {
  return (T(1) / length(a)) * a;
}
// The mirror image of w about the axis `axis` (both point away from the surface).
template <class T>
constexpr Vec3<T> reflect(Vec3<T> w, Vec3<T> axis) {
  return (T(2) * dot(w, axis)) * axis - w;
}
// The same about the normal: the direction of ideal reflection.
template <class T>
constexpr Vec3<T> mirror_direction(Vec3<T> w) {
  return {-w.x, -w.y, w.z};
}

// theta from the normal, phi from x towards y; radians.
template <class T>
Vec3<T> direction_from_angles(T theta, T phi) {
  const T s = sin(theta);
  return {s * cos(phi), s * sin(phi), cos(theta)};
}
template <class T>
T theta_of(Vec3<T> w) {
  return atan2(sqrt(w.x * w.x + w.y * w.y), w.z);
}
template <class T>
T phi_of(Vec3<T> w) {
  return atan2(w.y, w.x);
}

template <class T>
bool is_finite(Vec3<T> w) {
  return isfinite(w.x) && isfinite(w.y) && isfinite(w.z);
}

}  // namespace reflectree
