// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/incidence.hpp"

namespace reflectree::detail {

namespace {

// wo is folded, and the domain's frame follows.
void fold(const PackedViewer& viewer, Incidence& in, float sin_theta, float inverse) {
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

}  // namespace

void fold_viewer(const PackedViewer& viewer, Incidence& in, float sin_theta, float inverse) {
  fold(viewer, in, sin_theta, inverse);
  in.albedo = viewer.albedo.at(in.wo.z, in.phi_o);
}

}  // namespace reflectree::detail

namespace reflectree {

bool find_incidence(const PackedViewer& viewer, Direction wo, const Parameters& values, Incidence& out) {
  const float sin2 = wo.x * wo.x + wo.y * wo.y;
  if (!(wo.z >= min_cos_theta_o && abs(sin2 + wo.z * wo.z - 1) <= unit_length_tolerance)) return false;
  Coordinates at{};
  for (std::size_t i = 0; i < viewer.parameters.size(); ++i) {
    const KnownParameter& p = viewer.parameters[i];
    if (!p.range.contains(values[i])) return false;
    at[i] = clamp(coordinate_of(p, values[i]), lowest(p), highest(p));
  }
  const float sin_theta = sqrt(sin2), inverse = sin_theta > 0 ? 1 / sin_theta : 0.f;
  out.known = wo;
  out.wo = {sin_theta, 0, min(wo.z, 1.f)};
  std::size_t axis = 0;
  if (viewer.frame.isotropic()) {
    out.cos_phi = sin_theta > 0 ? wo.x * inverse : 1.f;
    out.sin_phi = wo.y * inverse;
  } else {
    detail::fold(viewer, out, sin_theta, inverse);
    out.known_beyond[axis++] = out.phi_o;
  }
  for (std::size_t i = 0; i < viewer.parameters.size(); ++i) out.known_beyond[axis++] = at[i];
  out.scale_x = scale_by(viewer.law.x, at), out.scale_y = scale_by(viewer.law.y, at);
  out.albedo = viewer.albedo.at(out.wo.z, out.phi_o, at);
  return out.albedo > 0;
}

}  // namespace reflectree
