// SPDX-License-Identifier: Apache-2.0
// The map of directions about the mirror direction, of wo or of the normal: its inverse and its measure.
#pragma once

#include "reflectree/sampler/square/domain_point.hpp"

namespace reflectree::detail {

// Polar coordinates (rho, phi) of wi about the mirror direction m = (-s, 0, z) of an axis (s, 0, z), which is
// wo or the normal; phi = 0 leans towards the horizon, along u = (-z, 0, -s). With t = tan(rho / 2) wi stays
// above the surface up to the rim
//   R = z / (s cos phi + sqrt(s^2 cos^2 phi + z^2)) = p / c,
// and the radius runs over it as in the star: t = y d, d = p / (p + (c - p) y), t' = d^2. There
//   wi.z = z d (1 - y) (R t + 1) / (1 + t^2), without cancellation,
//   d(solid angle) = 4 t / (1 + t^2)^2 dt dphi.
template <class T>
struct MirrorRim {
  T p, c;
  T zr;  // z R
};
template <class T>
REFLECTREE_INLINE MirrorRim<T> mirror_rim(T sin_theta_o, T cos_theta_o, T cos_phi) {
  const T sx = sin_theta_o * cos_phi;
  const T l = sqrt(sqr(cos_theta_o) + sx * sx) + abs(sx);
  return {by_sign(sx, cos_theta_o, l), by_sign(sx, l, cos_theta_o), by_sign(sx, sqr(cos_theta_o) / l, l)};
}
template <class T>
REFLECTREE_INLINE DomainPointT<T> lift_mirror_vector(Vec3<T> wo, Vec2<T> axis, Vec2<T> azimuth, T y) {
  y = max(y, T(1e-12f));
  const MirrorRim<T> rim = mirror_rim(axis.x, axis.y, azimuth.x);
  const T d = rim.p / (rim.p + (rim.c - rim.p) * y);
  const T t = y * d, tt = t * t, inverse = T(1) / (T(1) + tt);
  const T z = max(d * (T(1) - y) * (rim.zr * t + axis.y) * inverse, T(min_cos_theta_i));
  const Vec3<T> wi{-(axis.x * (T(1) - tt) + T(2) * t * axis.y * azimuth.x) * inverse,
                   T(2) * t * azimuth.y * inverse, z};
  // dphi = pi/2 dx, dx dy = 4 d(share).
  return {shading_geometry(wo, wi), z * T(8 * pi) * t * sqr(inverse) * (d * d)};
}

// t turned into |y|, with wi - m, which loses nothing near the pole.
struct LoweredMirrorVector {
  Direction about;  // wi in the frame of the mirror direction
  float y;
};
REFLECTREE_INLINE LoweredMirrorVector lower_mirror_vector(Direction wo, Direction wi) {
  const Direction off{wi.x + wo.x, wi.y, wi.z - wo.z};
  const Direction about{-wo.z * off.x - wo.x * off.z, wi.y, wo.z * wi.z - wo.x * wi.x};
  const float sin_rho = sqrt(max(sin2_theta(about), sqr(1e-7f)));
  const float t = about.z > 0 ? sin_rho / (1 + about.z) : (1 - about.z) / sin_rho;
  const MirrorRim<float> rim = mirror_rim(wo.x, wo.z, about.x / sin_rho);
  return {about, rim.p * t / (rim.p - (rim.c - rim.p) * t)};
}

}  // namespace reflectree::detail
