// SPDX-License-Identifier: Apache-2.0
// Everything that a reflectance formula asks about a pair of directions, computed once. A domain
// that sampled the half vector hands it on instead of recomputing it from wo + wi, which in float
// loses the sharpest lobes; an interval domain hands on its tightest enclosures.
#pragma once

#include "reflectree/math/direction.hpp"

namespace reflectree {

// wo: known, towards the viewer; wi: sampled, towards the light; wh = normalize(wo + wi).
// cos_theta_d = wo.wh = wi.wh. Models may assume cos_theta_o > 0 and cos_theta_i > 0.
template <class T>
struct ShadingGeometry {
  Vec3<T> wo, wi, wh;
  T cos_theta_o, cos_theta_i, cos_theta_h, cos_theta_d;
};

template <class T>
T sin2_theta(Vec3<T> w) {  // exact near the pole, where 1 - z^2 cancels
  return w.x * w.x + w.y * w.y;
}

// wo + wi, not normalised. Its rounding shows where wo and wi nearly cancel; (wo + wi).(wo - wi) = 0 for unit
// vectors, so that what the sum has along the difference is rounding and is taken out.
template <class T>
REFLECTREE_INLINE Vec3<T> sum_of_directions(Vec3<T> wo, Vec3<T> wi) {
  const Vec3<T> h = wo + wi;
  if constexpr (std::is_floating_point_v<T>) {
    if (dot(wo, wi) < T(0)) {
      const Vec3<T> m = wo - wi;
      return h - (dot(h, m) / dot(m, m)) * m;
    }
  }
  return h;
}

// wo + wi = 0 only when both graze; then the half vector is the normal by convention.
template <class T>
REFLECTREE_INLINE ShadingGeometry<T> shading_geometry(Vec3<T> wo, Vec3<T> wi) {
  const Vec3<T> h = sum_of_directions(wo, wi);
  const T length2 = dot(h, h);
  const T inverse = T(1) / sqrt(max(length2, T(1e-30)));
  const Vec3<T> wh = inverse * h;
  // wo.wh = |wo + wi| / 2 for unit vectors: free of cancellation at grazing.
  return {wo, wi, wh, wo.z, wi.z, wh.z, T(0.5) * length2 * inverse};
}

}  // namespace reflectree
