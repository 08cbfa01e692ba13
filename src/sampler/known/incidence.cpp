// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/incidence.hpp"

namespace reflectree::detail {

void fold_viewer_of_family(const PackedViewer& viewer, Incidence& in, float sin_theta, float inverse) {
  in.side = 0;
  // In the frame of the axis.
  Direction w = turn(in.known, viewer.cos_axis, -viewer.sin_axis);
  float cosine = viewer.cos_axis, sine = viewer.sin_axis;
  const auto half_turn = [&] { w.x = -w.x, w.y = -w.y, cosine = -cosine, sine = -sine; };
  switch (viewer.frame.symmetry) {
    case ViewerSymmetry::two_planes:  // mirroring x is mirroring y and half a turn
      if (w.x < 0) half_turn();
      if (w.y < 0) w.y = -w.y, in.side = -0.f;
      break;
    case ViewerSymmetry::one_plane:
      if (w.y < 0) w.y = -w.y, in.side = -0.f;
      break;
    case ViewerSymmetry::half_turn:
      if (w.y < 0) half_turn();
      break;
    default:
      break;
  }
  in.phi_o = angle_of(w.y, w.x);
  if (in.phi_o < 0) in.phi_o += 2 * pi;
  in.wo = {w.x, w.y, in.wo.z};
  if (viewer.turns) {
    in.wo = {sin_theta, 0, in.wo.z};
    const float c = sin_theta > 0 ? w.x * inverse : 1.f, s = w.y * inverse;
    // Turned by phi_o, perhaps mirrored, then turned by the axis: mirroring turns phi_o around.
    const float around = flip_sign(s, in.side);
    in.cos_phi = cosine * c - sine * around, in.sin_phi = sine * c + cosine * around;
  } else {
    in.cos_phi = cosine, in.sin_phi = sine;
  }
}

void fold_viewer(const PackedViewer& viewer, Incidence& in, float sin_theta, float inverse,
                 bool needs_albedo) {
  fold_viewer_of_family(viewer, in, sin_theta, inverse);
  in.albedo = needs_albedo || !viewer.albedo.positive ? viewer.albedo.at(in.wo.z, in.phi_o) : 1.f;
}

}  // namespace reflectree::detail
