// SPDX-License-Identifier: Apache-2.0
// Everything about wo that a sampler needs, computed once: its local frame, slabs and albedo.
#pragma once

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree {

struct Incidence {
  Direction known;         // wo as the caller gave it
  Direction wo;            // turned into the x-z plane
  float cos_phi, sin_phi;  // of the turn back
  float albedo;            // a(wo) of the target
};

// How far |wo|^2 may be from 1: what a renderer's rounding leaves.
inline constexpr float unit_length_tolerance = 1e-3f;

// False is "no sample": wo below or at the horizon, not finite, not of unit length, or albedo 0.
REFLECTREE_INLINE bool find_incidence(const PackedAlbedo& albedo, Direction wo, Incidence& out) {
  const float sin2 = wo.x * wo.x + wo.y * wo.y;
  if (!(wo.z >= min_cos_theta_o && abs(sin2 + wo.z * wo.z - 1) <= unit_length_tolerance)) return false;
  const float sin_theta = sqrt(sin2);
  out.known = wo;
  const float inverse = sin_theta > 0 ? 1 / sin_theta : 0.f;
  const float cos_theta = min(wo.z, 1.f);
  out.wo = {sin_theta, 0, cos_theta};
  out.cos_phi = sin_theta > 0 ? wo.x * inverse : 1.f;
  out.sin_phi = wo.y * inverse;
  out.albedo = albedo.at(cos_theta);
  return out.albedo > 0;
}

REFLECTREE_INLINE Direction from_incidence(const Incidence& in, Direction w) {
  return {w.x * in.cos_phi - w.y * in.sin_phi, w.x * in.sin_phi + w.y * in.cos_phi, w.z};
}
// What f is evaluated at: the sampler's own frame for functions that are isotropic by formula, which saves
// the turn; else the caller's.
REFLECTREE_INLINE ShadingGeometry<float> known_geometry(const Incidence& in, ShadingGeometry<float> g,
                                                        bool turned) {
  if (!turned) g.wo = in.known, g.wi = from_incidence(in, g.wi), g.wh = from_incidence(in, g.wh);
  return g;
}
REFLECTREE_INLINE Direction to_incidence(const Incidence& in, Direction w) {
  return {w.x * in.cos_phi + w.y * in.sin_phi, w.y * in.cos_phi - w.x * in.sin_phi, w.z};
}

}  // namespace reflectree
