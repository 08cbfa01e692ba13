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

// With x = p.x / |p| and h = hypot(cos_theta_o, sin_theta_o x): 1 + sin psi = P / h, 1 - sin psi = M / h for
// P M = cos^2 theta_o, of which only the larger may be found by adding. Then, for s = |p|^2,
//   g(s) = k0 s d,  g'(s) = k0 d^2,  d = P / (P + (2 k0 (h + sqrt(M h / 2)) - P) s).
// All is multiplied through by |p|, so that p needs no length.
struct HalfVectorStar {
  float p, rim;  // P and 2 k0 (h + sqrt(M h / 2))
};
REFLECTREE_INLINE HalfVectorStar half_vector_star(float sin_theta_o, float cos_theta_o, Vec2<float> p) {
  const float r2 = p.x * p.x + p.y * p.y;
  const float c2 = sqr(cos_theta_o) * r2, sx = sin_theta_o * p.x;
  const float h = sqrt(c2 + sx * sx);
  const float larger = h + abs(sx), smaller = c2 / max(larger, 1e-30f);
  const float plus = sx < 0 ? smaller : larger, minus = sx < 0 ? larger : smaller;
  return {plus, 2 * half_vector_k0 * (h + sqrt(0.5f * minus * h))};
}

// Rounding may carry the very rim of the square to the horizon or below: it stays just above.
inline constexpr float min_cos_theta_i = 1e-7f;

// side = -1: wo mirrored about the normal, for retro-reflective lobes.
REFLECTREE_INLINE DomainPoint lift_half_vector(Direction wo, Vec2<float> p, float side) {
  const HalfVectorStar star = half_vector_star(side * wo.x, wo.z, p);
  const float s = p.x * p.x + p.y * p.y;
  const float d = s > 0 ? star.p / (star.p + (star.rim - star.p) * s) : 1.f;
  const float g = half_vector_k0 * s * d;
  const float scale = sqrt(max(half_vector_k0 * d * (2 - g), 0.f));  // sin theta_h / r
  const Direction wh{p.x * scale, p.y * scale, 1 - g};
  const Direction axis{side * wo.x, 0, wo.z};
  const float cos_theta_d = axis.x * wh.x + axis.z * wh.z;
  const Direction wi{2 * cos_theta_d * wh.x - axis.x, 2 * cos_theta_d * wh.y,
                     max(2 * cos_theta_d * wh.z - axis.z, min_cos_theta_i)};
  // d(wi) = 4 (wo.wh) d(wh); share of the disk = pi.
  const float projected_area = wi.z * 4 * max(cos_theta_d, min_cos_theta_i) * 2 * pi * half_vector_k0 * d * d;
  if (side < 0) return {shading_geometry(wo, wi), projected_area};
  return {{wo, wi, wh, wo.z, wi.z, wh.z, cos_theta_d}, projected_area};
}

REFLECTREE_INLINE Vec2<float> lower_half_vector(Direction wo, Direction wi, float side) {
  const Direction wh = normalize(sum_of_directions(Direction{side * wo.x, 0, wo.z}, wi));
  const float s2 = sin2_theta(wh);
  if (!(s2 > 0)) return {};
  const HalfVectorStar star = half_vector_star(side * wo.x, wo.z, {wh.x, wh.y});
  const float g = s2 / (1 + wh.z);  // 1 - cos theta_h
  // g = k0 s d solved for s.
  const float s = star.p * g / (star.p * half_vector_k0 - (star.rim - star.p) * g);
  const float scale = sqrt(clamp(s, 0.f, 1.f) / s2);
  return {wh.x * scale, wh.y * scale};
}

}  // namespace detail

// wo = (sin theta_o, 0, cos theta_o); p in square coordinates.
REFLECTREE_INLINE DomainPoint lift(const Domain& domain, Direction wo, Vec2<float> p) {
  if (domain.kind == DomainKind::stretched) {
    // cos theta_i = v^(1 / (2 - a)) along the radius of the disk, v = 1 - r^2.
    const Vec2<float> d = square_to_disk(p);
    const float r2 = d.x * d.x + d.y * d.y;
    const float v = max(1 - r2, 1e-7f), power = 1 / (2 - domain.exponent);
    const float z = max(pow(v, power), detail::min_cos_theta_i);
    const float s = r2 > 0 ? sqrt((1 - z * z) / r2) : 0.f;
    // dz/dv = power z / v; d(solid angle) = dz dphi; d(share) = dv dphi / 2 pi.
    return {shading_geometry(wo, Direction{d.x * s, d.y * s, z}), 2 * pi * power * z * z / v};
  }
  const Vec2<float> d = square_to_disk(p);
  switch (domain.kind) {
    case DomainKind::half_vector:
      return detail::lift_half_vector(wo, d, 1);
    case DomainKind::back_vector:
      return detail::lift_half_vector(wo, d, -1);
    case DomainKind::projected_disk: {
      Direction wi = disk_to_hemisphere_projected(d);
      wi.z = max(wi.z, detail::min_cos_theta_i);
      return {shading_geometry(wo, wi), pi};
    }
    default: {
      Direction wi = disk_to_hemisphere_equal_area(d);
      wi.z = max(wi.z, detail::min_cos_theta_i);
      return {shading_geometry(wo, wi), 2 * pi * wi.z};
    }
  }
}

// The inverse of lift: square coordinates of wi (z > 0). With half domains wi.y must be >= 0.
REFLECTREE_INLINE Vec2<float> lower(const Domain& domain, Direction wo, Direction wi) {
  Vec2<float> d;
  switch (domain.kind) {
    case DomainKind::half_vector:
      d = detail::lower_half_vector(wo, wi, 1);
      break;
    case DomainKind::back_vector:
      d = detail::lower_half_vector(wo, wi, -1);
      break;
    case DomainKind::projected_disk:
      d = hemisphere_to_disk_projected(wi);
      break;
    case DomainKind::equal_area:
      d = hemisphere_to_disk_equal_area(wi);
      break;
    case DomainKind::stretched: {
      const float s2 = sin2_theta(wi);
      const float r2 = 1 - pow(wi.z, 2 - domain.exponent);
      const float scale = s2 > 0 ? sqrt(max(r2, 0.f) / s2) : 0.f;
      d = {wi.x * scale, wi.y * scale};
    }
  }
  const Vec2<float> p = disk_to_square(d);
  return {clamp(p.x, -1.f, 1.f), clamp(p.y, domain.half ? 0.f : -1.f, 1.f)};
}

}  // namespace reflectree
