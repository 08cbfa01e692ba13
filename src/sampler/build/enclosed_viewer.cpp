// SPDX-License-Identifier: Apache-2.0
#include "enclosed_viewer.hpp"

#include "enclosed_albedo.hpp"

namespace reflectree::detail {

namespace {

constexpr double u = 0x1p-24;

AffineForm clipped(AffineForm x, RealInterval range) {
  x.range = intersection(x.range, range);
  return x;
}
AffineForm slack(double size) { return AffineForm::anything_in({-size, size}); }

// By how much an azimuth that angle_of() tells may be off: 3e-7 of itself; where a whole turn is added to a negative
// one, that of half a turn, and two roundings.
double azimuth_error(ViewerSymmetry symmetry, double phi) {
  return symmetry == ViewerSymmetry::none || symmetry == ViewerSymmetry::isotropic ? 1.5e-6 : 4e-7 * phi;
}
double span_of(ViewerSymmetry symmetry) {
  switch (symmetry) {
    case ViewerSymmetry::two_planes:
      return 0.5 * pi_v<double>;
    case ViewerSymmetry::one_plane:
    case ViewerSymmetry::half_turn:
      return pi_v<double>;
    default:
      return 2 * pi_v<double>;
  }
}

// log_of_positive errs by less than 2.5e-7 of itself.
constexpr double coordinate_error = 2.6e-7;

Vec3<AffineForm> mirrored_y(Vec3<AffineForm> w) {
  w.y = -w.y;
  return w;
}
Vec3<AffineForm> half_turned(const Vec3<AffineForm>& w) { return {-w.x, -w.y, w.z}; }
Vec3<AffineForm> turned_by(const Vec3<AffineForm>& w, const AffineForm& cosine, const AffineForm& sine) {
  return {w.x * cosine - w.y * sine, w.x * sine + w.y * cosine, w.z};
}

}  // namespace

EnclosedViewer::EnclosedViewer(const PackedViewer& viewer, bool turned) : viewer_(viewer), azimuth_(!turned) {}

Elevations EnclosedViewer::elevations(const KnownRange& known) const {
  const RealInterval longer = RealInterval(1) + RealInterval(-length_tolerance, length_tolerance);
  const RealInterval theta = acos(RealInterval(known.lo, known.hi) / longer);
  return {std::max(theta.lo, 0.), std::min(theta.hi, 0.5 * pi_v<double>)};
}

std::array<RealInterval, 1 + max_parameters> EnclosedViewer::unknowns(const KnownRange& known) const {
  std::array<RealInterval, 1 + max_parameters> out{};
  std::size_t next = 0, slot = 0;
  if (azimuth_) {
    const ViewerSymmetry symmetry = viewer_.frame.symmetry;
    RealInterval phi{0, span_of(symmetry)};
    if (!viewer_.frame.isotropic()) {
      const RealInterval& floats = known.beyond[slot++];
      const double off = azimuth_error(symmetry, floats.hi);
      phi = {std::max(floats.lo - off, phi.lo), std::min(floats.hi + off, phi.hi)};
    }
    out[next++] = phi;
  }
  for (std::size_t i = 0; i < viewer_.family.count; ++i) {
    const RealInterval& floats = known.beyond[slot++];
    out[next++] = viewer_.family.parameters[i].logarithmic ? log(floats) : floats;
  }
  return out;
}

ViewerForms EnclosedViewer::over(const std::array<AffineForm, 2 + max_parameters>& unknown,
                                 const KnownRange& known) const {
  ViewerForms v;
  const AffineForm c = clipped(widened(cos(unknown[0]), length_tolerance), {double(known.lo), double(known.hi)});
  const AffineForm s = widened(sin(unknown[0]), length_tolerance);
  v.wo = v.framed = {s, AffineForm(0), c};
  std::size_t next = 1, slot = 0;
  AffineForm phi_o;
  if (azimuth_) {
    const AffineForm& phi = unknown[next++];
    const ViewerSymmetry symmetry = viewer_.frame.symmetry;
    v.cos_phi = cos(phi), v.sin_phi = sin(phi);
    if (symmetry == ViewerSymmetry::two_planes) v.cos_phi = clipped(v.cos_phi, {0, 1});
    if (span_of(symmetry) < 4) v.sin_phi = clipped(v.sin_phi, {0, 1});
    v.framed = {s * v.cos_phi, s * v.sin_phi, c};
    if (!axis_is_x()) {  // values at points are taken of directions that were turned there and back
      const AffineForm off = slack(8 * u * s.range.hi);
      v.framed.x = v.framed.x + off, v.framed.y = v.framed.y + off;
    }
    if (!viewer_.frame.isotropic()) {
      const double off = azimuth_error(symmetry, phi.range.hi);
      phi_o = clipped(phi + slack(off), known.beyond[slot++]);
    }
    if (!viewer_.turns) v.wo = v.framed;
  }
  const PackedFamily& family = viewer_.family;
  for (std::size_t i = 0; i < family.count; ++i) {
    const PackedParameter& p = family.parameters[i];
    const AffineForm& at = unknown[next++];
    const RealInterval& floats = known.beyond[slot++];
    v.parameters[i] = clipped(p.logarithmic ? exp(at) : at, floats);
    v.coordinates[i] = p.logarithmic ? at + slack(at.range.magnitude() * coordinate_error) : at;
    v.coordinates[i].range = intersection(v.coordinates[i].range, {double(p.lowest), double(p.highest)});
  }
  v.albedo = viewer_.frame.isotropic() && family.count == 0
                 ? albedo_over(viewer_.albedo, c)
                 : albedo_over(viewer_.albedo, c, phi_o, v.coordinates);
  return v;
}

Vec2<AffineForm> EnclosedViewer::widths(const ViewerForms& v) const {
  const PackedFamily& family = viewer_.family;
  const auto width = [&](const PackedWidth& w) {
    AffineForm exponent(0);
    for (std::size_t i = 0; i < family.count; ++i)
      exponent = exponent + AffineForm(w.slope[i]) * (v.coordinates[i] - AffineForm(w.corner[i]));
    return AffineForm(w.largest) * exp(exponent);
  };
  const AffineForm x = width(family.x);
  return {x, family.round ? x : width(family.y)};
}

std::vector<ViewerImage> EnclosedViewer::images(const BrdfEnclosure& of) const {
  const ViewerSymmetry symmetry = viewer_.frame.symmetry;
  const bool turns = (symmetry == ViewerSymmetry::two_planes || symmetry == ViewerSymmetry::half_turn) &&
                     !of.keeps_half_turns();
  const bool mirrors = is_mirrored(symmetry) && !(axis_is_x() && of.keeps_mirrored_axes());
  std::vector<ViewerImage> out;
  for (const bool half_turn : {false, true}) {
    for (const bool mirrored : {false, true}) {
      if ((turns || !half_turn) && (mirrors || !mirrored)) out.push_back({half_turn, mirrored});
    }
  }
  return out;
}

// Where the axis is x, images differ by signs alone; else the caller's directions are turned by what rounds.
ShadingGeometry<AffineForm> EnclosedViewer::for_caller(const ShadingGeometry<AffineForm>& g, const ViewerForms& v,
                                                       ViewerImage image) const {
  if (!azimuth_) return g;
  ShadingGeometry<AffineForm> out = g;
  out.back = std::nullopt;
  const auto imaged = [&](const Vec3<AffineForm>& w) {
    return image.half_turn ? half_turned(image.mirrored ? mirrored_y(w) : w)
                           : (image.mirrored ? mirrored_y(w) : w);
  };
  const AffineForm cosine(viewer_.cos_axis), sine(viewer_.sin_axis);
  const auto from_axis = [&](const Vec3<AffineForm>& w) {
    return axis_is_x() ? imaged(w) : turned_by(imaged(w), cosine, sine);
  };
  out.wo = from_axis(v.framed);
  if (!axis_is_x()) {  // the framed one is what rounds
    const AffineForm off = slack(8 * u * v.framed.x.range.magnitude() + 8 * u * v.framed.y.range.magnitude());
    out.wo.x = out.wo.x + off, out.wo.y = out.wo.y + off;
  }
  if (!viewer_.turns) {
    out.wi = from_axis(g.wi), out.wh = from_axis(g.wh);
    return out;
  }
  // Cosine and sine of phi_o are quotients of what was turned.
  AffineForm c = widened(v.cos_phi, 16 * u), s = widened(v.sin_phi, 16 * u);
  if (!axis_is_x()) c = c + slack(8 * u), s = s + slack(8 * u);
  if (axis_is_x()) {
    out.wi = imaged(turned_by(g.wi, c, s)), out.wh = imaged(turned_by(g.wh, c, s));
    return out;
  }
  const AffineForm around = image.mirrored ? -s : s;
  AffineForm cos_phi = cosine * c - sine * around, sin_phi = sine * c + cosine * around;
  if (image.half_turn) cos_phi = -cos_phi, sin_phi = -sin_phi;
  const auto to_caller = [&](const Vec3<AffineForm>& w) {
    return turned_by(image.mirrored ? mirrored_y(w) : w, cos_phi, sin_phi);
  };
  out.wi = to_caller(g.wi), out.wh = to_caller(g.wh);
  return out;
}

}  // namespace reflectree::detail
