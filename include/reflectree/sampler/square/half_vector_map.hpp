// SPDX-License-Identifier: Apache-2.0
// The map of half vectors about the normal, and of back vectors: its inverse and its measure.
#pragma once

#include "reflectree/sampler/square/domain_point.hpp"

namespace reflectree::detail {

// The half vectors wh whose reflection lies above the surface fill, at azimuth phi, the elevations up to
//   theta_max(phi) = pi/4 + psi/2,  tan psi = tan theta_o cos phi,
// a region that is a star about the normal. In slopes tau = tan theta_h its rim is
//   tau_max = sec psi + tan psi = P / cos_theta_o,  P = h + sin_theta_o cos phi,
//   h = hypot(cos_theta_o, sin_theta_o cos phi).
// The radius y in [0, 1] of the square runs over it by
//   tau(y) = y d,  d = P / (P + (cos_theta_o - P) y),  tau' = d^2:
// it meets the rim at y = 1, so that nothing of the square is wasted, and tau'(0) = 1 for every phi and wo,
// so that a specular lobe stays put. d(solid angle of wh) = tau cos^3 theta_h dtau dphi.

// P and cos_theta_o, both multiplied by L = h + |sin_theta_o cos phi|: P L is L^2, or cos^2 theta_o
// where P would cancel.
template <class T>
struct HalfVectorStar {
  T p, c;
};
template <class T>
REFLECTREE_INLINE HalfVectorStar<T> half_vector_star(T sin_theta_o, T cos_theta_o, T cos_phi) {
  const T c2 = sqr(cos_theta_o), sx = sin_theta_o * cos_phi;
  const T l = sqrt(c2 + sx * sx) + abs(sx);
  return {by_sign(sx, l * l, c2), cos_theta_o * l};
}

// cos theta_i = 2 (wo.n) / (n.n) - cos theta_o of a place of the star. Where nothing is known but a box of
// places (enclosed_map.hpp) the other arguments serve.
template <class T>
REFLECTREE_INLINE T reflected_cosine(T twice, T cos_theta_o, const HalfVectorStar<T>&, T, T, T) {
  return twice - cos_theta_o;
}

// d(wi) = 4 (wo.wh) d(wh); dphi = pi/2 dx, dx dy = 4 d(share). Times cos theta_i, or 1.
template <class T>
REFLECTREE_INLINE T half_vector_area(T cosine, T wo_n, T cos2_theta_h, T tau, T d) {
  return cosine * T(8 * pi) * wo_n * (cos2_theta_h * cos2_theta_h) * (tau * d * d);
}

// azimuth: unit vector; side = -1: wo mirrored about the normal, for retro-reflective lobes.
template <class T>
REFLECTREE_INLINE DomainPointT<T> lift_half_vector(Vec3<T> wo, Vec2<T> azimuth, T y, float side) {
  y = max(y, T(1e-12f));
  const Vec3<T> axis{T(side) * wo.x, T(0), wo.z};
  const HalfVectorStar<T> star = half_vector_star(axis.x, axis.z, azimuth.x);
  const T d = star.p / (star.p + (star.c - star.p) * y);
  const T tau = y * d;
  // n = (tau azimuth, 1) is parallel to wh: wi = 2 (wo.n) / (n.n) n - wo.
  const T nn = T(1) + tau * tau;
  const T wo_n = max(axis.x * azimuth.x * tau + axis.z, T(min_cos_theta_i));
  const T cos2_theta_h = T(1) / nn, twice = T(2) * wo_n * cos2_theta_h;
  const Vec3<T> wi{twice * tau * azimuth.x - axis.x, twice * tau * azimuth.y,
                   max(reflected_cosine(twice, axis.z, star, y, d, cos2_theta_h), T(min_cos_theta_i))};
  const T projected_area = half_vector_area(wi.z, wo_n, cos2_theta_h, tau, d);
  if (side < 0) return {shading_geometry(wo, wi), projected_area};
  const T cos_theta_h = sqrt(cos2_theta_h);
  const Vec3<T> wh{tau * azimuth.x * cos_theta_h, tau * azimuth.y * cos_theta_h, cos_theta_h};
  DomainPointT<T> out{{wo, wi, wh, wo.z, wi.z, cos_theta_h, wo_n * cos_theta_h}, projected_area};
  if constexpr (requires { out.area_by_cosine; })
    out.area_by_cosine = half_vector_area(T(1), wo_n, cos2_theta_h, tau, d);
  return out;
}

// The half vector of wi, and |y| of its place in the square.
struct LoweredHalfVector {
  Direction wh;
  float y;
};
REFLECTREE_INLINE LoweredHalfVector lower_half_vector(Direction wo, Direction wi, float side) {
  const Direction wh = normalize(sum_of_directions(Direction{side * wo.x, 0, wo.z}, wi));
  // No less than a rounding of wi: at the pole itself the density of a leaf would be infinite.
  const float sin_theta_h = sqrt(max(sin2_theta(wh), sqr(1e-7f)));
  const HalfVectorStar<float> star = half_vector_star(side * wo.x, wo.z, wh.x / sin_theta_h);
  const float tau = sin_theta_h / max(wh.z, 1e-12f);
  return {wh, star.p * tau / (star.p - (star.c - star.p) * tau)};  // tau = y d, solved for y
}

}  // namespace reflectree::detail
