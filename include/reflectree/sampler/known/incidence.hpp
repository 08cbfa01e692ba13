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
  // Of anisotropic functions: the azimuth in the viewer's frame, folded, where the albedo was asked for; by what
  // slabs are found (azimuth_key); by its sign bit, whether the frame is mirrored, y turned around, before it is
  // turned.
  float phi_o = 0, azimuth = 0, side = 0;
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

// wo in the frame of an anisotropic function's domain, and the way back: fields of Incidence, of floats or lanes.
template <class T>
struct FoldedFrame {
  Vec3<T> wo;
  T cos_phi, sin_phi, azimuth, side;
};
template <class T>
REFLECTREE_INLINE FoldedViewer<T> folded_by(const PackedViewer& viewer, T x, T y) {
  return fold_viewer(viewer.frame.symmetry, x, y, T(viewer.cos_axis), T(viewer.sin_axis));
}
template <class T>
REFLECTREE_INLINE FoldedFrame<T> folded_frame(const PackedViewer& viewer, const FoldedViewer<T>& f,
                                              T cos_theta, T sin2_theta) {
  const T azimuth = azimuth_key(viewer.frame.symmetry, f.x, f.y);
  if (!viewer.turns) return {{f.x, f.y, cos_theta}, f.cosine, f.sine, azimuth, f.side};
  const T sin_theta = sqrt(sin2_theta);
  const T inverse = T(1) / select(sin_theta > T(0), sin_theta, T(1));
  const T c = select(sin_theta > T(0), f.x * inverse, T(1)), s = f.y * inverse;
  // Turned by phi_o, perhaps mirrored, then turned by the axis: mirroring turns phi_o around.
  const T around = flip_sign(s, f.side);
  return {{sin_theta, T(0), cos_theta},
          f.cosine * c - f.sine * around,
          f.sine * c + f.cosine * around,
          azimuth,
          f.side};
}
// phi_o of a folded viewer, radians.
template <class T>
REFLECTREE_INLINE T azimuth_of(ViewerSymmetry symmetry, T x, T y) {
  if (symmetry == ViewerSymmetry::two_planes) return first_quadrant_angle(y, x);
  const T phi = angle_of(y, x);
  return select(phi < T(0), phi + T(2 * pi), phi);
}

// Out of the way of isotropic functions. The rest of find_incidence for all others: wo is folded, and the
// domain's frame follows.
void find_folded(const PackedViewer& viewer, Incidence& in, float sin2_theta);
// phi_o and the albedo.
void find_albedo(const PackedViewer& viewer, Incidence& in);

template <class T>
REFLECTREE_INLINE auto is_viewer(T cos_theta, T sin2_theta) {
  return (cos_theta >= T(min_cos_theta_o)) &
         (abs(sin2_theta + cos_theta * cos_theta - T(1)) <= T(unit_length_tolerance));
}
REFLECTREE_INLINE void turn_to_plane(Direction wo, float sin2_theta, Incidence& out) {
  const float sin_theta = sqrt(sin2_theta), inverse = sin_theta > 0 ? 1 / sin_theta : 0.f;
  out.wo = {sin_theta, 0, min(wo.z, 1.f)};
  out.cos_phi = sin_theta > 0 ? wo.x * inverse : 1.f;
  out.sin_phi = wo.y * inverse;
}
// Whether what does not need the albedo is spared it: it takes long and is 0 nowhere.
REFLECTREE_INLINE bool spares_albedo(const PackedViewer& viewer) { return viewer.albedo.positive; }

}  // namespace detail

// False is "no sample": wo below or at the horizon, not finite, not of unit length, or albedo 0. Who does not
// need the albedo, or not at once, is spared it where it is 0 nowhere, unless it costs next to nothing.
REFLECTREE_INLINE bool find_incidence(const PackedViewer& viewer, Direction wo, Incidence& out,
                                      bool needs_albedo = true) {
  const float sin2 = wo.x * wo.x + wo.y * wo.y;
  if (!detail::is_viewer(wo.z, sin2)) return false;
  out.known = wo;
  if (viewer.frame.isotropic()) {
    detail::turn_to_plane(wo, sin2, out);
    out.albedo = viewer.albedo.at(out.wo.z);
    return out.albedo > 0;
  }
  detail::find_folded(viewer, out, sin2);
  if (!needs_albedo && detail::spares_albedo(viewer)) return true;
  detail::find_albedo(viewer, out);
  return out.albedo > 0;
}

// Of a family; parameters outside of their ranges are "no sample", too.
inline bool find_incidence(const PackedViewer& viewer, Direction wo, const Parameters& values, Incidence& out,
                           bool needs_albedo = true) {
  const float sin2 = wo.x * wo.x + wo.y * wo.y;
  if (!detail::is_viewer(wo.z, sin2)) return false;
  Coordinates& at = out.coordinates;
  if (!find_coordinates(viewer.family, values, at)) return false;
  out.known = wo;
  if (viewer.frame.isotropic()) {
    detail::turn_to_plane(wo, sin2, out);
    out.known_beyond = {values[0], values[1]};
  } else {
    detail::find_folded(viewer, out, sin2);
    out.known_beyond = {out.azimuth, values[0], values[1]};
  }
  out.scale_x = viewer.family.x.at(at);
  out.scale_y = viewer.family.round ? out.scale_x : viewer.family.y.at(at);
  if (!needs_albedo && detail::spares_albedo(viewer)) return true;
  detail::find_albedo(viewer, out);
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
