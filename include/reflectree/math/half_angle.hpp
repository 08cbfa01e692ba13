// SPDX-License-Identifier: Apache-2.0
// Half-angle coordinates of a pair of directions. Rusinkiewicz 1998, "A New Change of Variables for
// Efficient BRDF Representation": the half vector wh, and wi in the frame whose pole is wh ("difference
// vector"). An isotropic function does not depend on phi_h; a reciprocal one has period pi in phi_d.
#pragma once

#include "reflectree/math/direction.hpp"

namespace reflectree {

// Radians. theta_h in [0, pi], theta_d in [0, pi/2], phi_h and phi_d in [-pi, pi].
template <class T>
struct HalfAngle {
  T theta_h, phi_h, theta_d, phi_d;
};

// wo and wi are unit vectors, wo + wi != 0. With m = wi - wo and h = wo + wi (orthogonal, since both
// have unit length) tan theta_d = |m| / |h|, and m turned into the frame of wh lies in its x-y plane:
// no cancellation near theta_d = 0, where wi itself would give none of phi_d's digits.
template <class T>
HalfAngle<T> to_half_angle(Vec3<T> wo, Vec3<T> wi) {
  const Vec3<T> h = wo + wi, m = wi - wo;
  const T sin_h = sqrt(h.x * h.x + h.y * h.y);  // times |h|
  const T length_h = length(h);
  const T cos_phi = sin_h > T(0) ? h.x / sin_h : T(1);
  const T sin_phi = sin_h > T(0) ? h.y / sin_h : T(0);
  const T d_x = (h.z * (cos_phi * m.x + sin_phi * m.y) - sin_h * m.z) / length_h;
  const T d_y = cos_phi * m.y - sin_phi * m.x;
  return {atan2(sin_h, h.z), atan2(sin_phi, cos_phi), atan2(length(m), length_h), atan2(d_y, d_x)};
}

template <class T>
struct DirectionPair {
  Vec3<T> wo, wi;
};

// The inverse: the difference vector and its mirror image about the pole, turned by theta_h about y and
// then by phi_h about z.
template <class T>
DirectionPair<T> from_half_angle(const HalfAngle<T>& a) {
  const T sin_h = sin(a.theta_h), cos_h = cos(a.theta_h);
  const T sin_phi = sin(a.phi_h), cos_phi = cos(a.phi_h);
  const auto turn = [&](Vec3<T> d) {
    const T x = cos_h * d.x + sin_h * d.z;
    return Vec3<T>{cos_phi * x - sin_phi * d.y, sin_phi * x + cos_phi * d.y, cos_h * d.z - sin_h * d.x};
  };
  const Vec3<T> d = direction_from_angles(a.theta_d, a.phi_d);
  return {turn({-d.x, -d.y, d.z}), turn(d)};
}

}  // namespace reflectree
