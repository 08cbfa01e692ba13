// SPDX-License-Identifier: Apache-2.0
#include "enclosed_viewer.hpp"

#include "enclosed_albedo.hpp"

namespace reflectree::detail {

namespace {

constexpr double u = 0x1p-24;

// Cosines and sines that would be 0 but for the rounding of their angle.
constexpr float tiny = 1e-6f;

AffineForm clipped(AffineForm x, RealInterval range) {
  x.range = intersection(x.range, range);
  return x;
}
AffineForm slack(double size) { return AffineForm::anything_in({-size, size}); }

// By how much an azimuth that angle_of() tells may be off: 3e-7 of itself; where a whole turn is added to a negative
// one, that of half a turn, and two roundings. A slab is found by azimuth_key, which ascends at least half as fast:
// in the first quadrant both keys err by 3 u of themselves, up to half a turn by 4 u, beyond that by 7 u, and so the
// azimuth by no more than this.
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

Vec3<AffineForm> turned_by(const Vec3<AffineForm>& w, const AffineForm& cosine, const AffineForm& sine) {
  return {w.x * cosine - w.y * sine, w.x * sine + w.y * cosine, w.z};
}

}  // namespace

EnclosedViewer::EnclosedViewer(const PackedViewer& viewer, bool turned)
    : viewer_(viewer), azimuth_(!turned) {}

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
  const AffineForm c =
      clipped(widened(cos(unknown[0]), length_tolerance), {double(known.lo), double(known.hi)});
  const AffineForm s = clipped(widened(sin(unknown[0]), length_tolerance), {0, 2});
  v.wo = v.framed = {s, AffineForm(0), c}, v.sine = s;
  std::size_t next = 1, slot = 0;
  AffineForm phi_o;
  if (azimuth_) {
    const AffineForm& phi = unknown[next++];
    const ViewerSymmetry symmetry = viewer_.frame.symmetry;
    v.phi = phi, v.cos_phi = cos(phi), v.sin_phi = sin(phi);
    if (symmetry == ViewerSymmetry::two_planes) v.cos_phi = clipped(v.cos_phi, {0, 1});
    if (span_of(symmetry) < 4) v.sin_phi = clipped(v.sin_phi, {0, 1});
    v.framed = {s * v.cos_phi, s * v.sin_phi, c};
    if (viewer_.sin_axis != 0) {  // values at points are taken of directions that were turned there and back
      const AffineForm off = slack(8 * u * s.range.hi);
      v.framed.x = v.framed.x + off, v.framed.y = v.framed.y + off;
    }
    if (!viewer_.frame.isotropic()) {
      const double off = azimuth_error(symmetry, phi.range.hi);
      phi_o = clipped(phi + slack(off), {0, span_of(symmetry) + off});
      ++slot;
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

DomainForms EnclosedViewer::domain_of(const Domain& domain, const ViewerForms& v) const {
  const PackedFamily& family = viewer_.family;
  const auto width = [&](const PackedWidth& w) {
    AffineForm exponent(0);
    for (std::size_t i = 0; i < family.count; ++i)
      exponent = exponent + AffineForm(w.slope[i]) * (v.coordinates[i] - AffineForm(w.corner[i]));
    return AffineForm(w.largest) * exp(exponent);
  };
  DomainForms out{domain.kind, domain.exponent, domain.stretch, AffineForm(domain.scale_x),
                  AffineForm(domain.scale_y)};
  if (domain.kind != DomainKind::scaled_star || family.count == 0) return out;
  out.scale_x = width(family.x), out.scale_y = family.round ? out.scale_x : width(family.y);
  return out;
}

bool EnclosedViewer::axis_is_coordinate() const {
  return min(abs(viewer_.sin_axis), abs(viewer_.cos_axis)) < tiny;
}

std::vector<ViewerImage> EnclosedViewer::images(const ExactSymmetry& keeps) const {
  const ViewerSymmetry symmetry = viewer_.frame.symmetry;
  const bool turns =
      (symmetry == ViewerSymmetry::two_planes || symmetry == ViewerSymmetry::half_turn) && !keeps.half_turns;
  const bool mirrors = is_mirrored(symmetry) && !(axis_is_coordinate() && keeps.mirrored_axes);
  std::vector<ViewerImage> out;
  for (const bool half_turn : {false, true}) {
    for (const bool mirrored : {false, true}) {
      if ((turns || !half_turn) && (mirrors || !mirrored)) out.push_back({half_turn, mirrored});
    }
  }
  return out;
}

// From the frame of the axis. Where that is x or y but for the rounding of an angle, what is left of the other
// coordinate is slack; so sets of directions and of their mirror images stay mirror images of each other.
Vec3<AffineForm> EnclosedViewer::from_axis(const Vec3<AffineForm>& w) const {
  const float c = viewer_.cos_axis, s = viewer_.sin_axis;
  const auto times = [](float k, const AffineForm& v) {
    return k == 1 ? v : k == -1 ? -v : AffineForm(k) * v;
  };
  const auto plus = [](const AffineForm& v, float k, const AffineForm& other) {
    return k == 0 ? v : v + slack(std::abs(double(k)) * other.range.magnitude());
  };
  if (abs(s) < tiny) return {plus(times(c, w.x), s, w.y), plus(times(c, w.y), s, w.x), w.z};
  if (abs(c) < tiny) return {plus(times(-s, w.y), c, w.x), plus(times(s, w.x), c, w.y), w.z};
  return turned_by(w, AffineForm(c), AffineForm(s));
}

HalfSlopes EnclosedViewer::slopes_from_axis(HalfSlopes h) const {
  h.known = h.known && !viewer_.turns && axis_is_coordinate();
  const double c = std::abs(double(viewer_.cos_axis)), s = std::abs(double(viewer_.sin_axis));
  if (c < s) std::swap(h.widths.x, h.widths.y), std::swap(h.azimuth.x, h.azimuth.y);
  h.turn += std::min(c, s);
  return h;
}

// g in the frame of the domain. Turns by an axis or by phi_o round: azimuths err by 8 u or so.
KnownViewer EnclosedViewer::known_of(const ShadingGeometry<AffineForm>& g, const ViewerForms& v,
                                     ViewerImage image) const {
  constexpr double rounding = 2e-6;
  const bool framed = viewer_.sin_axis == 0 && viewer_.cos_axis > 0;
  const double axis = std::atan2(double(viewer_.sin_axis), double(viewer_.cos_axis));
  const auto imaged = [&](const AffineForm& angle, bool rounds) {
    const double by = (image.half_turn ? pi_v<double> : 0) + axis, off = rounds ? rounding : 0;
    const AffineForm a = image.mirrored ? -angle : angle;
    return linear_enclosure(a, 1, {by - off, by + off}, {a.range.lo + by - off, a.range.hi + by + off});
  };
  KnownViewer out{widened(v.sine, 8 * u), imaged(v.phi, !framed)};
  const HalfAzimuth* half = viewer_.turns ? known_azimuth(g) : g.azimuth_h ? &*g.azimuth_h : nullptr;
  if (half) out.azimuth_h = imaged(viewer_.turns ? half->angle + v.phi : half->angle, viewer_.turns || !framed);
  if (viewer_.turns) out.wi = Vec3<AffineForm>{g.wi.x, image.mirrored ? -g.wi.y : g.wi.y, g.wi.z};
  return out;
}

ShadingGeometry<AffineForm> EnclosedViewer::for_caller(const ShadingGeometry<AffineForm>& g,
                                                       const ViewerForms& v, ViewerImage image) const {
  if (!azimuth_) return g;
  const auto imaged = [&](Vec3<AffineForm> w) {
    if (image.mirrored) w.y = -w.y;
    if (image.half_turn) w.x = -w.x, w.y = -w.y;
    return from_axis(w);
  };
  ShadingGeometry<AffineForm> out = g;
  out.back = std::nullopt, out.azimuth_i = std::nullopt, out.viewer = known_of(g, v, image);
  out.slopes = slopes_from_axis(g.slopes);
  out.wo = imaged(v.framed);
  if (viewer_.sin_axis != 0) {  // it is the framed one that rounds
    const AffineForm off = slack(8 * u * v.framed.x.range.magnitude() + 8 * u * v.framed.y.range.magnitude());
    out.wo.x = out.wo.x + off, out.wo.y = out.wo.y + off;
  }
  if (!viewer_.turns) {
    out.wi = imaged(g.wi), out.wh = imaged(g.wh);
    return out;
  }
  // One turn by phi_o and the axis together, whose cosine and sine are sums of quotients of what was turned.
  AffineForm c = widened(v.cos_phi, 16 * u), s = widened(v.sin_phi, 16 * u);
  if (viewer_.sin_axis != 0) c = c + slack(16 * u), s = s + slack(16 * u);
  out.wi = imaged(turned_by(g.wi, c, s)), out.wh = imaged(turned_by(g.wh, c, s));
  return out;
}

}  // namespace reflectree::detail
