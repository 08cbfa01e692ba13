// SPDX-License-Identifier: Apache-2.0
// The map of each domain (domain.hpp), with its inverse and its measure.
#pragma once

#include "reflectree/brdf/shading_geometry.hpp"
#include "reflectree/math/square_maps.hpp"
#include "reflectree/sampler/square/domain.hpp"

namespace reflectree {

// A point of the square, lifted. `projected_area` = d(projected solid angle of wi) / d(share of the
// square), so that T = t * projected_area integrates over the whole square (area 1) to the albedo;
// pdf_disk = density per share / projected_area.
template <class T>
struct DomainPointT {
  ShadingGeometry<T> geometry;
  T projected_area;  // > 0
};
using DomainPoint = DomainPointT<float>;

namespace detail {

// The half vectors wh whose reflection lies above the surface fill, at azimuth phi, the elevations up to
//   theta_max(phi) = pi/4 + psi/2,  tan psi = tan theta_o cos phi,
// a region that is a star about the normal. In slopes tau = tan theta_h, with h = hypot(cos_theta_o,
// sin_theta_o cos phi), its rim is tau_max = sec psi + tan psi = P / cos_theta_o, P = h + sin_theta_o cos
// phi. The radius y in [0, 1] of the square runs over it by
//   tau(y) = y d,  d = P / (P + (cos_theta_o - P) y),  tau' = d^2:
// it meets the rim at y = 1, so that nothing of the square is wasted, and tau'(0) = 1 for every phi and wo,
// so that a specular lobe stays put. d(solid angle of wh) = tau cos^3 theta_h dtau dphi.

// P and cos_theta_o, both multiplied by L = h + |sin_theta_o cos phi|: P L is L^2, or, where P would cancel,
// cos^2 theta_o.
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

// Rounding may carry the very rim of the square to the horizon or below: it stays just above.
inline constexpr float min_cos_theta_i = 1e-7f;

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
  // d(wi) = 4 (wo.wh) d(wh); dphi = pi/2 dx, dx dy = 4 d(share).
  const T projected_area = wi.z * T(8 * pi) * wo_n * (cos2_theta_h * cos2_theta_h) * (tau * d * d);
  if (side < 0) return {shading_geometry(wo, wi), projected_area};
  const T cos_theta_h = sqrt(cos2_theta_h);
  const Vec3<T> wh{tau * azimuth.x * cos_theta_h, tau * azimuth.y * cos_theta_h, cos_theta_h};
  return {{wo, wi, wh, wo.z, wi.z, cos_theta_h, wo_n * cos_theta_h}, projected_area};
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

// Polar coordinates (rho, phi) of wi about the mirror direction m = (-s, 0, z) of an axis (s, 0, z), which is
// wo or the normal; phi = 0 leans towards the horizon, along u = (-z, 0, -s). With t = tan(rho / 2) wi stays
// above the surface up to the rim
//   R = z / (s cos phi + sqrt(s^2 cos^2 phi + z^2)) = p / c,
// and the radius runs over it as in the star: t = y d, d = p / (p + (c - p) y), t' = d^2. There
//   wi.z = z d (1 - y) (R t + 1) / (1 + t^2) without cancellation, d(solid angle) = 4 t / (1 + t^2)^2 dt
//   dphi.
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

// In slopes, n = (tau, 1), the half vectors whose reflection of wo lies above the surface fill the disc
//   |tau - t|^2 < 1 + |t|^2,  t = (wo.x, wo.y) / wo.z,
// which is a star about the normal, and so is its image under a linear map S = diag(s, 1/s): with
// tau = S r u(phi), u the unit circle, its rim is at
//   r = R = (b + sqrt(b^2 + q wo.z^2)) / (q wo.z),  q = |S u|^2,  b = S u . (wo.x, wo.y),
// and the radius runs over it as above, r = y d, d = p / (p + (c - p) y) with p / c = R, r' = d^2;
// d(slopes) = det S r dr dphi, det S = 1.
template <class T>
struct SlopeStar {
  Vec2<T> along;  // S u
  T p, c;
};
template <class T>
REFLECTREE_INLINE SlopeStar<T> slope_star(Vec3<T> wo, Vec2<T> u, T stretch) {
  const Vec2<T> along{stretch * u.x, u.y / stretch};
  const T q = along.x * along.x + along.y * along.y, b = along.x * wo.x + along.y * wo.y;
  const T l = sqrt(b * b + q * sqr(wo.z)) + abs(b);  // for b < 0, R = wo.z / l: nothing cancels
  return {along, by_sign(b, l, wo.z), by_sign(b, q * wo.z, l)};
}
template <class T>
REFLECTREE_INLINE DomainPointT<T> lift_slope_star(Vec3<T> wo, T stretch, Vec2<T> azimuth, T y) {
  y = max(y, T(1e-12f));
  const SlopeStar<T> star = slope_star(wo, azimuth, stretch);
  const T d = star.p / (star.p + (star.c - star.p) * y), r = y * d;
  const Vec2<T> tau{r * star.along.x, r * star.along.y};
  const T nn = T(1) + tau.x * tau.x + tau.y * tau.y;
  const T wo_n = max(wo.x * tau.x + wo.y * tau.y + wo.z, T(min_cos_theta_i));
  const T cos2_theta_h = T(1) / nn, twice = T(2) * wo_n * cos2_theta_h;
  const Vec3<T> wi{twice * tau.x - wo.x, twice * tau.y - wo.y, max(twice - wo.z, T(min_cos_theta_i))};
  const T projected_area = wi.z * T(8 * pi) * wo_n * (cos2_theta_h * cos2_theta_h) * (r * d * d);
  const T cos_theta_h = sqrt(cos2_theta_h);
  const Vec3<T> wh{tau.x * cos_theta_h, tau.y * cos_theta_h, cos_theta_h};
  return {{wo, wi, wh, wo.z, wi.z, cos_theta_h, wo_n * cos_theta_h}, projected_area};
}
// With S = diag(a, b), for families: d(slopes) = a b r dr dphi.
template <class T>
REFLECTREE_INLINE SlopeStar<T> scaled_star(Vec3<T> wo, Vec2<T> u, Vec2<T> scale) {
  const Vec2<T> along{scale.x * u.x, scale.y * u.y};
  const T q = along.x * along.x + along.y * along.y, b = along.x * wo.x + along.y * wo.y;
  const T l = sqrt(b * b + q * sqr(wo.z)) + abs(b);
  return {along, by_sign(b, l, wo.z), by_sign(b, q * wo.z, l)};
}
template <class T>
REFLECTREE_INLINE DomainPointT<T> lift_scaled_star(Vec3<T> wo, Vec2<T> scale, Vec2<T> azimuth, T y) {
  y = max(y, T(1e-12f));
  const SlopeStar<T> star = scaled_star(wo, azimuth, scale);
  const T d = star.p / (star.p + (star.c - star.p) * y), r = y * d;
  const Vec2<T> tau{r * star.along.x, r * star.along.y};
  const T nn = T(1) + tau.x * tau.x + tau.y * tau.y;
  const T wo_n = max(wo.x * tau.x + wo.y * tau.y + wo.z, T(min_cos_theta_i));
  const T cos2_theta_h = T(1) / nn, twice = T(2) * wo_n * cos2_theta_h;
  const Vec3<T> wi{twice * tau.x - wo.x, twice * tau.y - wo.y, max(twice - wo.z, T(min_cos_theta_i))};
  const T det = scale.x * scale.y;
  const T projected_area = wi.z * T(8 * pi) * wo_n * (cos2_theta_h * cos2_theta_h) * (det * r * d * d);
  const T cos_theta_h = sqrt(cos2_theta_h);
  const Vec3<T> wh{tau.x * cos_theta_h, tau.y * cos_theta_h, cos_theta_h};
  return {{wo, wi, wh, wo.z, wi.z, cos_theta_h, wo_n * cos_theta_h}, projected_area};
}
// The azimuth's direction u in the square, and |y|.
struct LoweredSlopes {
  Vec2<float> u;
  float y;
};
REFLECTREE_INLINE LoweredSlopes lower_slope_star(Direction wo, Direction wi, float stretch) {
  const Direction wh = normalize(sum_of_directions(wo, wi));
  const float z = max(wh.z, 1e-12f);
  // No less than a rounding of wi: at the pole itself the density of a leaf would be infinite.
  const Vec2<float> v{wh.x / (z * stretch), wh.y / z * stretch};
  const float r = max(sqrt(v.x * v.x + v.y * v.y), 1e-7f);
  const Vec2<float> u = v.x == 0 && v.y == 0 ? Vec2<float>{1, 0} : Vec2<float>{v.x / r, v.y / r};
  const SlopeStar<float> star = slope_star(wo, u, stretch);
  return {u, star.p * r / (star.p - (star.c - star.p) * r)};
}

REFLECTREE_INLINE LoweredSlopes lower_scaled_star(Direction wo, Direction wi, Vec2<float> scale) {
  const Direction wh = normalize(sum_of_directions(wo, wi));
  const float z = max(wh.z, 1e-12f);
  // No less than a rounding of wi, as above.
  const Vec2<float> v{wh.x / (z * scale.x), wh.y / (z * scale.y)};
  const float r = max(sqrt(v.x * v.x + v.y * v.y), 1e-7f / max(scale.x, scale.y));
  const Vec2<float> u = v.x == 0 && v.y == 0 ? Vec2<float>{1, 0} : Vec2<float>{v.x / r, v.y / r};
  const SlopeStar<float> star = scaled_star(wo, u, scale);
  return {u, star.p * r / (star.p - (star.c - star.p) * r)};
}

// x in [-1, 1] of the azimuth of w, |phi| = pi/2 (1 - x).
REFLECTREE_INLINE float lower_azimuth(Direction w) {
  const float a = abs(w.x), b = abs(w.y);
  if (a == 0 && b == 0) return 1;
  const float x = a > b ? 1 - 0.5f * quarter_atan(b / a) : 0.5f * quarter_atan(a / b);
  return w.x < 0 ? -x : x;
}

// lift() for floats or lanes.
template <class T>
REFLECTREE_INLINE DomainPointT<T> lift_point(const Domain& domain, Vec3<T> wo, Vec2<T> p) {
  const Vec2<T> half_azimuth = cos_sin_half(p.x);
  const T y = abs(p.y);
  // cos phi = sin(pi x / 2), sin phi = cos(pi x / 2), on the side of y.
  const Vec2<T> azimuth{half_azimuth.y, flip_sign(half_azimuth.x, p.y)};
  switch (domain.kind) {
    case DomainKind::half_vector:
      return lift_half_vector(wo, azimuth, y, 1);
    case DomainKind::back_vector:
      return lift_half_vector(wo, azimuth, y, -1);
    case DomainKind::mirror_vector:
      return lift_mirror_vector(wo, Vec2<T>{wo.x, wo.z}, azimuth, y);
    case DomainKind::normal_vector:
      return lift_mirror_vector(wo, Vec2<T>{T(0), T(1)}, azimuth, y);
    case DomainKind::slope_star:
      return lift_slope_star(wo, T(domain.stretch), azimuth, y);
    case DomainKind::scaled_star:
      return lift_scaled_star(wo, Vec2<T>{T(domain.scale_x), T(domain.scale_y)}, azimuth, y);
    case DomainKind::projected_disk: {
      const T r = sqrt(y), z = max(sqrt(T(1) - y), T(min_cos_theta_i));
      return {shading_geometry(wo, Vec3<T>{r * azimuth.x, r * azimuth.y, z}), T(pi)};
    }
    case DomainKind::equal_area: {
      const T r = sqrt(y * (T(2) - y)), z = max(T(1) - y, T(min_cos_theta_i));
      return {shading_geometry(wo, Vec3<T>{r * azimuth.x, r * azimuth.y, z}), T(2 * pi) * z};
    }
    default: {  // stretched: cos theta_i = v^(1 / (2 - a)), v = 1 - y; d(share) = dv dphi / 2 pi
      const float power = 1 / (2 - domain.exponent);
      const T v = max(T(1) - y, T(1e-7f));
      const T z = max(pow(v, T(power)), T(min_cos_theta_i));
      const T r = sqrt(T(1) - z * z);
      return {shading_geometry(wo, Vec3<T>{r * azimuth.x, r * azimuth.y, z}), T(2 * pi * power) * z * z / v};
    }
  }
}

}  // namespace detail

// wo = (sin theta_o, 0, cos theta_o), or any for domains in the frame of the surface; p in square coordinates
// (domain.hpp); `mirrored` turns wi.y around, the coin of half domains.
REFLECTREE_INLINE DomainPoint lift(const Domain& domain, Direction wo, Vec2<float> p, bool mirrored = false) {
  return detail::lift_point(domain, wo, {p.x, flip_sign(p.y, mirrored ? -0.f : 0.f)});
}

// Calls body(domain) with a kind that the compiler knows: the choice is made once, outside of a sample.
template <class Body>
REFLECTREE_INLINE auto with_known_kind(Domain domain, Body&& body) {
  switch (domain.kind) {
    case DomainKind::half_vector:
      domain.kind = DomainKind::half_vector;
      return body(domain);
    case DomainKind::back_vector:
      domain.kind = DomainKind::back_vector;
      return body(domain);
    case DomainKind::mirror_vector:
      domain.kind = DomainKind::mirror_vector;
      return body(domain);
    case DomainKind::normal_vector:
      domain.kind = DomainKind::normal_vector;
      return body(domain);
    case DomainKind::projected_disk:
      domain.kind = DomainKind::projected_disk;
      return body(domain);
    case DomainKind::equal_area:
      domain.kind = DomainKind::equal_area;
      return body(domain);
    case DomainKind::slope_star:
      domain.kind = DomainKind::slope_star;
      return body(domain);
    case DomainKind::scaled_star:
      domain.kind = DomainKind::scaled_star;
      return body(domain);
    default:
      domain.kind = DomainKind::stretched;
      return body(domain);
  }
}

// The inverse of lift: square coordinates of wi (z > 0). With half domains wi.y must be >= 0.
REFLECTREE_INLINE Vec2<float> lower(const Domain& domain, Direction wo, Direction wi) {
  Direction turned = wi;
  float y = 0;
  switch (domain.kind) {
    case DomainKind::half_vector:
    case DomainKind::back_vector: {
      const auto at = detail::lower_half_vector(wo, wi, domain.kind == DomainKind::half_vector ? 1.f : -1.f);
      turned = at.wh;
      y = at.y;
      break;
    }
    case DomainKind::mirror_vector:
    case DomainKind::normal_vector: {
      const bool mirror = domain.kind == DomainKind::mirror_vector;
      const auto at = detail::lower_mirror_vector(mirror ? wo : Direction{0, 0, 1}, wi);
      turned = at.about;
      y = at.y;
      break;
    }
    case DomainKind::slope_star: {
      const auto at = detail::lower_slope_star(wo, wi, domain.stretch);
      turned = {at.u.x, at.u.y, 0};
      y = at.y;
      break;
    }
    case DomainKind::scaled_star: {
      const auto at = detail::lower_scaled_star(wo, wi, {domain.scale_x, domain.scale_y});
      turned = {at.u.x, at.u.y, 0};
      y = at.y;
      break;
    }
    case DomainKind::projected_disk:
      y = sin2_theta(wi);
      break;
    case DomainKind::equal_area:
      y = sin2_theta(wi) / (1 + wi.z);
      break;  // 1 - cos without cancellation
    case DomainKind::stretched:
      y = 1 - pow(wi.z, 2 - domain.exponent);
      break;
  }
  y = clamp(y, 0.f, 1.f);
  return {detail::lower_azimuth(turned), !domain.half() && turned.y < 0 ? -y : y};
}

}  // namespace reflectree
