// SPDX-License-Identifier: Apache-2.0
// From a point of a domain's square to a direction, and back: the choice among the maps.
#pragma once

#include "reflectree/math/square_maps.hpp"
#include "reflectree/sampler/square/domain.hpp"
#include "reflectree/sampler/square/half_vector_map.hpp"
#include "reflectree/sampler/square/mirror_vector_map.hpp"
#include "reflectree/sampler/square/slope_star_map.hpp"

namespace reflectree {

namespace detail {

// x in [-1, 1] of the azimuth of w, |phi| = pi/2 (1 - x).
REFLECTREE_INLINE float lower_azimuth(Direction w) {
  const float a = abs(w.x), b = abs(w.y);
  if (a == 0 && b == 0) return 1;
  const float x = a > b ? 1 - 0.5f * quarter_atan(b / a) : 0.5f * quarter_atan(a / b);
  return w.x < 0 ? -x : x;
}

// What a domain knows of its map beyond the formula: boxes do (enclosed_map.hpp).
template <class D, class Map>
REFLECTREE_INLINE const Map& map_of(const D&, const Map& map) {
  return map;
}

// lift() for floats, lanes, or boxes, whose domain may have widths of its own (enclosed_map.hpp).
template <class T, class D>
REFLECTREE_INLINE DomainPointT<T> lift_point(const D& domain, Vec3<T> wo, Vec2<T> p) {
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
      return lift_slopes(wo, map_of(domain, Stretched<T>{T(domain.stretch)}), azimuth, y);
    case DomainKind::scaled_star:
      return lift_slopes(wo, map_of(domain, Scaled<T>{{T(domain.scale_x), T(domain.scale_y)}}), azimuth, y);
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
    case DomainKind::slope_star:
    case DomainKind::scaled_star: {
      const auto at =
          domain.kind == DomainKind::slope_star
              ? detail::lower_slopes(wo, wi, detail::Stretched<float>{domain.stretch})
              : detail::lower_slopes(wo, wi, detail::Scaled<float>{{domain.scale_x, domain.scale_y}});
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
