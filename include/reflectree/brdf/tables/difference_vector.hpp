// SPDX-License-Identifier: Apache-2.0
// The difference vector of Rusinkiewicz's half-angle coordinates for a given shading geometry, in float.
#pragma once

#include "reflectree/brdf/shading_geometry.hpp"

namespace reflectree::detail {

// d: wi in the frame whose pole is the half vector, turned to azimuth 0. m = (wi - wo) / 2 is orthogonal to
// wh and as long as sin theta_d; turned into that frame it is (d.x, d.y, 0): as in to_half_angle().
template <class T>
struct Difference {
  T sin_theta_h;
  Vec3<T> d;
};
inline Difference<float> difference_vector(const ShadingGeometry<float>& g) {
  const float sin_h = sqrt(sin2_theta(g.wh)), inverse = 1.f / max(sin_h, 1e-30f);
  const float cos_phi = select(sin_h > 0.f, g.wh.x * inverse, 1.f), sin_phi = g.wh.y * inverse;
  const Vec3<float> m = 0.5f * (g.wi - g.wo);
  const float dx = g.cos_theta_h * (cos_phi * m.x + sin_phi * m.y) - sin_h * m.z;
  const float dy = cos_phi * m.y - sin_phi * m.x;
  return {sin_h, {dx, dy, g.cos_theta_d}};
}

}  // namespace reflectree::detail
