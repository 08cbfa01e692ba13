// SPDX-License-Identifier: Apache-2.0
// The map of each domain (domain.hpp), with its inverse and its measure. wo lies in the x-z plane.
#pragma once

#include <optional>

#include "reflectree/brdf/shading_geometry.hpp"
#include "reflectree/math/square_maps.hpp"
#include "reflectree/sampler/domain.hpp"

namespace reflectree {

// A point of the square, lifted. `projected_area` = d(projected solid angle of wi) / d(share of the
// square), so that T = t * projected_area integrates over the whole square (area 1) to the albedo;
// pdf_disk = density per share / projected_area.
struct DomainPoint {
  ShadingGeometry<float> geometry;
  float projected_area;  // > 0
};

namespace detail {

// The half vectors wh whose reflection lies above the surface fill, at azimuth phi, the elevations up to
//   theta_max(phi) = pi/4 + psi/2,  tan psi = tan theta_o cos phi:
// a region that is a star about the normal. With s = r^2 on the disk,
//   1 - cos theta_h = g(s) = k0 s / (1 + (k0/k - 1) s),  k = 1 - cos theta_max(phi),  k0 = 1 - cos(pi/4),
// reaches the rim of the star at s = 1, so that nothing of the square is wasted, while g'(0) = k0 for every
// phi and wo, so that a specular lobe stays put. d(solid angle of wh) / d(disk area) = 2 g'(s).
inline constexpr float half_vector_k0 = 0.292893219f;

// With h = hypot(cos_theta_o, sin_theta_o cos phi): 1 + sin psi = P / h, 1 - sin psi = M / h for
// P M = cos^2 theta_o, of which only the larger may be found by adding. Then
//   g(s) = k0 s d,  g'(s) = k0 d^2,  d = P / (P + (R - P) s),  R = 2 k0 (h + sqrt(M h / 2)).
struct HalfVectorStar {
  float p, rim;  // P and R
};
REFLECTREE_INLINE HalfVectorStar half_vector_star(float sin_theta_o, float cos_theta_o, float cos_phi) {
  const float c2 = sqr(cos_theta_o), sx = sin_theta_o * cos_phi;
  const float h = sqrt(c2 + sx * sx);
  const float larger = h + abs(sx), smaller = c2 / larger;
  const float plus = select(sx < 0, smaller, larger), minus = select(sx < 0, larger, smaller);
  return {plus, 2 * half_vector_k0 * (h + sqrt(0.5f * minus * h))};
}

// Rounding may carry the very rim of the square to the horizon or below: it stays just above.
inline constexpr float min_cos_theta_i = 1e-7f;

// azimuth: unit vector; r: radius in the disk; side = -1: wo mirrored about the normal, for retro-reflection.
REFLECTREE_INLINE DomainPoint lift_half_vector(Direction wo, Vec2<float> azimuth, float r, float side) {
  r = max(r, 1e-12f);
  const HalfVectorStar star = half_vector_star(side * wo.x, wo.z, azimuth.x);
  const float s = r * r;
  const float d = star.p / (star.p + (star.rim - star.p) * s);
  const float g = half_vector_k0 * s * d;
  const float sin_theta_h = r * sqrt(max(half_vector_k0 * d * (2 - g), 0.f));
  const Direction wh{azimuth.x * sin_theta_h, azimuth.y * sin_theta_h, 1 - g};
  const Direction axis{side * wo.x, 0, wo.z};
  const float cos_theta_d = axis.x * wh.x + axis.z * wh.z;
  const Direction wi{2 * cos_theta_d * wh.x - axis.x, 2 * cos_theta_d * wh.y,
                     max(2 * cos_theta_d * wh.z - axis.z, min_cos_theta_i)};
  // d(wi) = 4 (wo.wh) d(wh); d(wh) = 2 g' d(disk area); d(disk area) = 2 pi r d(share).
  const float projected_area =
      wi.z * 4 * max(cos_theta_d, min_cos_theta_i) * 4 * pi * half_vector_k0 * d * d * r;
  if (side < 0) return {shading_geometry(wo, wi), projected_area};
  return {{wo, wi, wh, wo.z, wi.z, wh.z, cos_theta_d}, projected_area};
}

// The half vector of wi, and |y| of its place in the square.
struct LoweredHalfVector {
  Direction wh;
  float r;
};
REFLECTREE_INLINE LoweredHalfVector lower_half_vector(Direction wo, Direction wi, float side) {
  const Direction wh = normalize(sum_of_directions(Direction{side * wo.x, 0, wo.z}, wi));
  const float s2 = sin2_theta(wh);
  if (!(s2 > 0)) return {wh, 0};
  const HalfVectorStar star = half_vector_star(side * wo.x, wo.z, wh.x / sqrt(s2));
  const float g = s2 / (1 + wh.z);  // 1 - cos theta_h
  // g = k0 s d solved for s.
  return {wh, sqrt(clamp(star.p * g / (star.p * half_vector_k0 - (star.rim - star.p) * g), 0.f, 1.f))};
}

// x in [-1, 1] of the azimuth of w, |phi| = pi/2 (1 - x).
REFLECTREE_INLINE float lower_azimuth(Direction w) {
  const float a = abs(w.x), b = abs(w.y);
  if (a == 0 && b == 0) return 1;
  const float x = a > b ? 1 - 0.5f * quarter_atan(b / a) : 0.5f * quarter_atan(a / b);
  return w.x < 0 ? -x : x;
}

}  // namespace detail

// wo = (sin theta_o, 0, cos theta_o); p in square coordinates (domain.hpp).
REFLECTREE_INLINE DomainPoint lift(const Domain& domain, Direction wo, Vec2<float> p) {
  const Vec2<float> half_azimuth = detail::cos_sin_half(p.x);
  const float y = abs(p.y);
  // cos phi = sin(pi x / 2), sin phi = cos(pi x / 2), on the side of y.
  const Vec2<float> azimuth{half_azimuth.y, p.y < 0 ? -half_azimuth.x : half_azimuth.x};
  switch (domain.kind) {
    case DomainKind::half_vector:
      return detail::lift_half_vector(wo, azimuth, y, 1);
    case DomainKind::back_vector:
      return detail::lift_half_vector(wo, azimuth, y, -1);
    case DomainKind::projected_disk: {
      const float r = sqrt(y), z = max(sqrt(1 - y), detail::min_cos_theta_i);
      return {shading_geometry(wo, Direction{r * azimuth.x, r * azimuth.y, z}), pi};
    }
    case DomainKind::equal_area: {
      const float r = sqrt(y * (2 - y)), z = max(1 - y, detail::min_cos_theta_i);
      return {shading_geometry(wo, Direction{r * azimuth.x, r * azimuth.y, z}), 2 * pi * z};
    }
    default: {  // stretched: cos theta_i = v^(1 / (2 - a)), v = 1 - y; d(share) = dv dphi / 2 pi
      const float v = max(1 - y, 1e-7f), power = 1 / (2 - domain.exponent);
      const float z = max(pow(v, power), detail::min_cos_theta_i);
      const float r = sqrt(1 - z * z);
      return {shading_geometry(wo, Direction{r * azimuth.x, r * azimuth.y, z}), 2 * pi * power * z * z / v};
    }
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
      y = at.r;
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
  return {detail::lower_azimuth(turned), !domain.half && turned.y < 0 ? -y : y};
}

}  // namespace reflectree
