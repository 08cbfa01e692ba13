// SPDX-License-Identifier: Apache-2.0
// Everything about wo that a sampler needs, computed once: its local frame, slabs and albedo.
#pragma once

#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree {

struct Incidence {
  Direction wo;            // turned into the x-z plane
  float cos_phi, sin_phi;  // of the turn back
  float albedo;            // a(wo) of the target
};

// False is "no sample": wo below or at the horizon, not finite, or albedo 0.
REFLECTREE_INLINE bool find_incidence(const PackedSampler& packed, Direction wo, Incidence& out) {
  if (!(wo.z >= min_cos_theta_o && wo.z <= 1.00001f)) return false;
  const float sin_theta = sqrt(wo.x * wo.x + wo.y * wo.y);
  if (!(sin_theta <= 1.00001f)) return false;
  const float inverse = sin_theta > 0 ? 1 / sin_theta : 0.f;
  const float cos_theta = min(wo.z, 1.f);
  out.wo = {sin_theta, 0, cos_theta};
  out.cos_phi = sin_theta > 0 ? wo.x * inverse : 1.f;
  out.sin_phi = wo.y * inverse;
  out.albedo = packed.albedo_at(cos_theta);
  return out.albedo > 0;
}

REFLECTREE_INLINE Direction from_incidence(const Incidence& in, Direction w) {
  return {w.x * in.cos_phi - w.y * in.sin_phi, w.x * in.sin_phi + w.y * in.cos_phi, w.z};
}
REFLECTREE_INLINE Direction to_incidence(const Incidence& in, Direction w) {
  return {w.x * in.cos_phi + w.y * in.sin_phi, w.y * in.cos_phi - w.x * in.sin_phi, w.z};
}

}  // namespace reflectree
