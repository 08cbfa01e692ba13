// SPDX-License-Identifier: Apache-2.0
// The map of half vectors by their slopes, stretched: its inverse and its measure.
#pragma once

#include "reflectree/sampler/square/domain_point.hpp"

namespace reflectree::detail {

// In slopes, n = (tau, 1), the half vectors whose reflection of wo lies above the surface fill the disc
//   |tau - t|^2 < 1 + |t|^2,  t = (wo.x, wo.y) / wo.z,
// which is a star about the normal, and so is its image under a linear map S = diag(a, b): with
// tau = S r u(phi), u the unit circle, its rim is at
//   r = R = (b + sqrt(b^2 + q wo.z^2)) / (q wo.z),  q = |S u|^2,  b = S u . (wo.x, wo.y),
// and the radius runs over it as for half vectors, r = y d, d = p / (p + (c - p) y) with p / c = R, r' = d^2;
// d(slopes) = det S r dr dphi.

// S = diag(s, 1/s): det S = 1.
template <class T>
struct Stretched {
  T s;
  REFLECTREE_INLINE Vec2<T> along(Vec2<T> u) const { return {s * u.x, u.y / s}; }
  REFLECTREE_INLINE T area(T r) const { return r; }  // det S r
  // S^-1 of the slopes of n = (x, y, z).
  REFLECTREE_INLINE Vec2<T> back(T x, T y, T z) const { return {x / (z * s), y / z * s}; }
  REFLECTREE_INLINE T least_radius() const { return T(1e-7f); }
};
// S of the two widths of a family's member.
template <class T>
struct Scaled {
  Vec2<T> widths;
  REFLECTREE_INLINE Vec2<T> along(Vec2<T> u) const { return {widths.x * u.x, widths.y * u.y}; }
  REFLECTREE_INLINE T area(T r) const { return widths.x * widths.y * r; }
  REFLECTREE_INLINE Vec2<T> back(T x, T y, T z) const { return {x / (z * widths.x), y / (z * widths.y)}; }
  REFLECTREE_INLINE T least_radius() const { return T(1e-7f) / max(widths.x, widths.y); }
};

template <class T>
struct SlopeStar {
  T p, c;
};
template <class T>
REFLECTREE_INLINE SlopeStar<T> slope_star(Vec3<T> wo, Vec2<T> along) {
  const T q = along.x * along.x + along.y * along.y, b = along.x * wo.x + along.y * wo.y;
  const T l = sqrt(b * b + q * sqr(wo.z)) + abs(b);  // for b < 0, R = wo.z / l: nothing cancels
  return {by_sign(b, l, wo.z), by_sign(b, q * wo.z, l)};
}
// d of a place of the star, and n.n.
template <class T>
REFLECTREE_INLINE T radius_per_y(const SlopeStar<T>& star, T y) {
  return star.p / (star.p + (star.c - star.p) * y);
}
template <class T>
REFLECTREE_INLINE T squared_normal(const Vec2<T>& tau, const Vec2<T>&, T) {
  return T(1) + tau.x * tau.x + tau.y * tau.y;
}
// wo.n, n = (tau, 1).
template <class T>
REFLECTREE_INLINE T cosine_to_normal(const Vec3<T>& wo, const Vec2<T>& tau, const SlopeStar<T>&,
                                     const Vec2<T>&, T, T) {
  return wo.x * tau.x + wo.y * tau.y + wo.z;
}
// cos theta_i = 2 (wo.n) / (n.n) - cos theta_o of a place of the star. Where nothing is known but a box of
// places (enclosed_map.hpp) the other arguments serve.
template <class T>
REFLECTREE_INLINE T reflected_cosine(T twice, const Vec3<T>& wo, const SlopeStar<T>&, const Vec2<T>&, T, T,
                                     T) {
  return twice - wo.z;
}
// d(wi) = 4 (wo.wh) d(wh), dx dy = 4 d(share). Times cos theta_i, or 1.
template <class T>
REFLECTREE_INLINE T slope_star_area(T cosine, T wo_n, T cos2_theta_h, T area, T d) {
  return cosine * T(8 * pi) * wo_n * (cos2_theta_h * cos2_theta_h) * (area * d * d);
}
template <class T, class Map>
REFLECTREE_INLINE SlopeStar<T> star_of(const Map&, const Vec3<T>& wo, const Vec2<T>& along) {
  return slope_star(wo, along);
}
template <class T, class Map>
REFLECTREE_INLINE DomainPointT<T> lift_slopes(Vec3<T> wo, const Map& map, Vec2<T> azimuth, T y) {
  y = max(y, T(1e-12f));
  const Vec2<T> along = map.along(azimuth);
  const SlopeStar<T> star = star_of(map, wo, along);
  const T d = radius_per_y(star, y), r = y * d;
  const Vec2<T> tau{r * along.x, r * along.y};
  const T nn = squared_normal(tau, along, r);
  const T wo_n = max(cosine_to_normal(wo, tau, star, along, y, d), T(min_cos_theta_i));
  const T cos2_theta_h = T(1) / nn, twice = T(2) * wo_n * cos2_theta_h;
  const Vec3<T> wi{twice * tau.x - wo.x, twice * tau.y - wo.y,
                   max(reflected_cosine(twice, wo, star, along, y, d, cos2_theta_h), T(min_cos_theta_i))};
  const T projected_area = slope_star_area(wi.z, wo_n, cos2_theta_h, map.area(r), d);
  const T cos_theta_h = sqrt(cos2_theta_h);
  const Vec3<T> wh{tau.x * cos_theta_h, tau.y * cos_theta_h, cos_theta_h};
  DomainPointT<T> out{{wo, wi, wh, wo.z, wi.z, cos_theta_h, wo_n * cos_theta_h}, projected_area};
  if constexpr (requires { out.geometry.slopes; })
    out.geometry.slopes = {true, r, map.along(Vec2<T>{T(1), T(1)}), azimuth};
  if constexpr (requires { out.area_by_cosine; })
    out.area_by_cosine = slope_star_area(T(1), wo_n, cos2_theta_h, map.area(r), d);
  return out;
}

// The azimuth's direction u in the square, and |y|.
struct LoweredSlopes {
  Vec2<float> u;
  float y;
};
template <class Map>
REFLECTREE_INLINE LoweredSlopes lower_slopes(Direction wo, Direction wi, const Map& map) {
  const Direction wh = normalize(sum_of_directions(wo, wi));
  const Vec2<float> v = map.back(wh.x, wh.y, max(wh.z, 1e-12f));
  // No less than a rounding of wi: at the pole itself the density of a leaf would be infinite.
  const float r = max(sqrt(v.x * v.x + v.y * v.y), map.least_radius());
  const Vec2<float> u = v.x == 0 && v.y == 0 ? Vec2<float>{1, 0} : Vec2<float>{v.x / r, v.y / r};
  const SlopeStar<float> star = slope_star(wo, map.along(u));
  return {u, star.p * r / (star.p - (star.c - star.p) * r)};
}

}  // namespace reflectree::detail
