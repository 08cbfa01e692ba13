// SPDX-License-Identifier: Apache-2.0
// Everything about wo that a sampler needs, computed once: its turned frame, its azimuth and its albedo.
#pragma once

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/math/fast_functions.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/known/packed_family.hpp"
#include "reflectree/sampler/known/viewer_frame.hpp"

namespace reflectree {

struct Incidence {
  Direction known;         // wo as the caller gave it
  Direction wo;            // in the frame of the domain
  float cos_phi, sin_phi;  // of the turn back
  float albedo;            // a(wo) of the target; not 0 where it was not asked for
  float phi_o = 0;         // of anisotropic functions: the azimuth in the viewer's frame, folded
  float side = 0;          // its sign bit: the frame is mirrored, y turned around, before it is turned
  // Of families: what is known but theta_o, in the order of the partition, with parameters as they were given;
  // these as coordinates; and the domain's widths.
  std::array<float, 1 + max_parameters> known_beyond;
  Coordinates coordinates;
  float scale_x, scale_y;
};

// What is known of a sampler's viewers.
struct PackedViewer {
  PackedAlbedo albedo;
  ViewerFrame frame = {};
  float cos_axis = 1, sin_axis = 0;
  bool turns = true;  // the domain lives in the frame where wo has no y, rather than in the viewer's frame
  PackedFamily family = {};
};

// How far |wo|^2 may be from 1: what a renderer's rounding leaves.
inline constexpr float unit_length_tolerance = 1e-3f;

namespace detail {
// The rest of find_incidence for anisotropic functions, out of the way of all others: wo is folded, and the
// domain's frame and the albedo follow.
void fold_viewer(const PackedViewer& viewer, Incidence& in, float sin_theta, float inverse,
                 bool needs_albedo);
// The same without the albedo, which a family knows by its parameters, too.
void fold_viewer_of_family(const PackedViewer& viewer, Incidence& in, float sin_theta, float inverse);
}  // namespace detail

// False is "no sample": wo below or at the horizon, not finite, not of unit length, or albedo 0. Who does not
// need the albedo is spared it where it is 0 nowhere, unless it costs next to nothing.
REFLECTREE_INLINE bool find_incidence(const PackedViewer& viewer, Direction wo, Incidence& out,
                                      bool needs_albedo = true) {
  const float sin2 = wo.x * wo.x + wo.y * wo.y;
  if (!(wo.z >= min_cos_theta_o && abs(sin2 + wo.z * wo.z - 1) <= unit_length_tolerance)) return false;
  const float sin_theta = sqrt(sin2);
  out.known = wo;
  const float inverse = sin_theta > 0 ? 1 / sin_theta : 0.f;
  const float cos_theta = min(wo.z, 1.f);
  out.wo = {sin_theta, 0, cos_theta};
  if (viewer.frame.isotropic()) {
    out.cos_phi = sin_theta > 0 ? wo.x * inverse : 1.f;
    out.sin_phi = wo.y * inverse;
    out.albedo = viewer.albedo.at(cos_theta);
  } else {
    detail::fold_viewer(viewer, out, sin_theta, inverse, needs_albedo);
  }
  return out.albedo > 0;
}

// Of a family; parameters outside of their ranges are "no sample", too.
inline bool find_incidence(const PackedViewer& viewer, Direction wo, const Parameters& values, Incidence& out,
                           bool needs_albedo = true) {
  const float sin2 = wo.x * wo.x + wo.y * wo.y;
  if (!(wo.z >= min_cos_theta_o && abs(sin2 + wo.z * wo.z - 1) <= unit_length_tolerance)) return false;
  Coordinates& at = out.coordinates;
  if (!find_coordinates(viewer.family, values, at)) return false;
  const float sin_theta = sqrt(sin2), inverse = sin_theta > 0 ? 1 / sin_theta : 0.f;
  out.known = wo;
  out.wo = {sin_theta, 0, min(wo.z, 1.f)};
  if (viewer.frame.isotropic()) {
    out.cos_phi = sin_theta > 0 ? wo.x * inverse : 1.f;
    out.sin_phi = wo.y * inverse;
    out.known_beyond = {values[0], values[1]};
  } else {
    detail::fold_viewer_of_family(viewer, out, sin_theta, inverse);
    out.known_beyond = {out.phi_o, values[0], values[1]};
  }
  out.scale_x = viewer.family.x.at(at);
  out.scale_y = viewer.family.round ? out.scale_x : viewer.family.y.at(at);
  out.albedo = 1;
  if (!needs_albedo && viewer.albedo.positive) return true;
  out.albedo = viewer.albedo.at(out.wo.z, out.phi_o, at);
  return out.albedo > 0;
}

REFLECTREE_INLINE Direction from_incidence(const Incidence& in, Direction w) {
  return turn({w.x, flip_sign(w.y, in.side), w.z}, in.cos_phi, in.sin_phi);
}
// What f is evaluated at: the sampler's own frame for functions that are isotropic by formula, which saves
// the turn; else the caller's.
REFLECTREE_INLINE ShadingGeometry<float> known_geometry(const Incidence& in, ShadingGeometry<float> g,
                                                        bool turned) {
  if (!turned) g.wo = in.known, g.wi = from_incidence(in, g.wi), g.wh = from_incidence(in, g.wh);
  return g;
}
REFLECTREE_INLINE Direction to_incidence(const Incidence& in, Direction w) {
  const Direction turned{w.x * in.cos_phi + w.y * in.sin_phi, w.y * in.cos_phi - w.x * in.sin_phi, w.z};
  return {turned.x, flip_sign(turned.y, in.side), turned.z};
}

}  // namespace reflectree
