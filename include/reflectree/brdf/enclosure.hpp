// SPDX-License-Identifier: Apache-2.0
// A BRDF over boxes of directions: its own formula, with affine forms in place of floats. Bounds that are
// proofs rest on it (docs/exactness.md).
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/parameter.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/math/affine_form.hpp"

namespace reflectree {

// The geometry over a box has more where the map knows it (enclosed_map.hpp): the half vector of wo and of wi
// mirrored about the normal, and its cosine with wo; the azimuth of wh, which wh does not tell where it meets the
// normal: cosine and sine up to 1e-6 of themselves, and radians; of maps of directions the azimuth of wi, radians.
struct BackVector {
  Vec3<AffineForm> wh;
  AffineForm cos_theta_d;
};
struct HalfAzimuth {
  AffineForm cosine, sine, angle;
};
// Of maps of slopes: wh.x / wh.z = r widths.x azimuth.x, likewise y, up to signs; |azimuth| = 1 up to 1.2e-6.
struct HalfSlopes {
  bool known = false;
  AffineForm r;
  Vec2<AffineForm> widths, azimuth;
  double turn = 0;  // by which the frame may be off, radians
};
// What directions do not tell at the normal, and where azimuths leap, of viewers whose azimuth matters. Azimuths are
// those of the floats, in radians, of any branch; wi is there where the map turns wo to azimuth 0, up to 16 roundings.
struct KnownViewer {
  AffineForm sin_theta_o, azimuth;
  std::optional<AffineForm> azimuth_h = std::nullopt;
  std::optional<Vec3<AffineForm>> wi = std::nullopt;
};
template <>
struct ShadingGeometry<AffineForm> {
  Vec3<AffineForm> wo, wi, wh;
  AffineForm cos_theta_o, cos_theta_i, cos_theta_h, cos_theta_d;
  std::optional<BackVector> back = std::nullopt;
  std::optional<HalfAzimuth> azimuth_h = std::nullopt;
  std::optional<AffineForm> azimuth_i = std::nullopt;
  HalfSlopes slopes = {};
  std::optional<KnownViewer> viewer = std::nullopt;
};

// The azimuth that the map told, while g is in the frame in which it told it: a geometry that was turned or mirrored
// since has none.
inline const HalfAzimuth* known_azimuth(const ShadingGeometry<AffineForm>& g) {
  if (!g.azimuth_h || g.wo.y.range.magnitude() > 0 || g.wo.x.range.lo < 0) return nullptr;
  const RealInterval sine = g.azimuth_h->sine.range, y = g.wi.y.range;
  return (sine.lo >= 0 && y.lo >= 0) || (sine.hi <= 0 && y.hi <= 0) ? &*g.azimuth_h : nullptr;
}

// wo + wi over a box, as in shading_geometry.hpp. Where the two may point apart the float formula takes out what
// the sum has along the difference m: h - k m, k = (|wo|^2 - |wi|^2) / |m|^2. Both lengths are 1 up to
// length_tolerance, and |m|^2 > 2 there: the correction, with the roundings of its own, is less than
// 4 length_tolerance, and |k| less than 2.5.
// That is much where wo and wi nearly cancel. But what is left is orthogonal to m, and so for wo.y = 0
//   h.x = (h.y wi.y - h.z (wo.z - wi.z)) / m.x,  h.y = (1 + k) wi.y,  h.z = wo.z + wi.z - k (wo.z - wi.z),
// of which only h.x is rounded by more than itself: by less than 10 u |h| + 10 u 4 length_tolerance, u = 2^-24.
inline constexpr double length_tolerance = 1e-6;
inline Vec3<AffineForm> sum_of_directions(const Vec3<AffineForm>& wo, const Vec3<AffineForm>& wi) {
  const Vec3<AffineForm> h = wo + wi;
  const RealInterval cosine = dot(wo, wi).range;
  if (cosine.lo >= 0) return h;
  constexpr double most = 4 * length_tolerance, u = 0x1p-24;
  const AffineForm mended = AffineForm::anything_in({-most, most});
  const Vec3<AffineForm> plain{h.x + mended, h.y + mended, h.z + mended};
  const AffineForm apart = wo.x - wi.x;
  if (wo.y.range.magnitude() > 0 || !(apart.range.lo > 0.5)) return plain;
  const AffineForm y = widened(h.y, 2.5 * length_tolerance), z = widened(h.z, 2.5 * length_tolerance);
  const AffineForm x = (y * wi.y - z * (wo.z - wi.z)) / apart;
  const double size = x.range.magnitude() + y.range.magnitude() + z.range.magnitude();
  const double off = 10 * u * (size + most) + (cosine.hi < 0 ? 0 : most);
  return {narrower(plain.x, x + AffineForm::anything_in({-off, off})), narrower(plain.y, y),
          narrower(plain.z, z)};
}

// wh and wh.wo from the ratios of the sum's coordinates: at grazing all of them are as small as the cosine of
// wo. What the float formula rounds is relative: the sum's square errs by 3 u, the inverse of its root by 4 u.
inline ShadingGeometry<AffineForm> shading_geometry(const Vec3<AffineForm>& wo, const Vec3<AffineForm>& wi) {
  constexpr double share = 8 * 0x1p-24;
  const Vec3<AffineForm> h = sum_of_directions(wo, wi);
  if (!(h.z.range.lo > 1e-14)) return shading_geometry<AffineForm>(wo, wi);
  const AffineForm x = h.x / h.z, y = h.y / h.z;
  const AffineForm nn = AffineForm(1) + (sqr(x) + sqr(y));
  const AffineForm root = sqrt(nn), cosine = widened(AffineForm(1) / root, share);
  Vec3<AffineForm> wh{x * cosine, y * cosine, cosine};
  for (AffineForm* v : {&wh.x, &wh.y, &wh.z}) v->range = intersection(v->range, {-1 - share, 1 + share});
  return {wo, wi, wh, wo.z, wi.z, wh.z, widened(AffineForm(0.5) * h.z * root, share)};
}

// For retro_reflector.hpp.
inline ShadingGeometry<AffineForm> back_geometry(const ShadingGeometry<AffineForm>& g) {
  const Vec3<AffineForm> wi = mirror_direction(g.wi);
  if (!g.back) return shading_geometry(g.wo, wi);
  return {g.wo, wi, g.back->wh, g.wo.z, wi.z, g.back->wh.z, g.back->cos_theta_d};
}

// The same for wi on the other side of the plane of wo, where wo has no y.
inline ShadingGeometry<AffineForm> mirrored_in_plane(ShadingGeometry<AffineForm> g) {
  g.wi.y = -g.wi.y, g.wh.y = -g.wh.y;
  if (g.back) g.back->wh.y = -g.back->wh.y;
  if (g.azimuth_h) g.azimuth_h->sine = -g.azimuth_h->sine, g.azimuth_h->angle = -g.azimuth_h->angle;
  if (g.azimuth_i) g.azimuth_i = -*g.azimuth_i;
  return g;
}

// x^2 + y^2 of a unit vector is 1 - z^2, too: of the two forms the narrower. What lengths, and both formulas,
// round is less than 3 length_tolerance.
inline AffineForm sin2_theta(const Vec3<AffineForm>& w) {
  const AffineForm plain = sqr(w.x) + sqr(w.y);
  const AffineForm slack = AffineForm::anything_in({-3 * length_tolerance, 3 * length_tolerance});
  return narrower(plain, AffineForm(1) - sqr(w.z) + slack);
}

// For ggx.hpp. Of a unit vector it is alpha^2 + (1 - alpha^2) sin^2, too: where nothing else is known of w it is no
// less than alpha^2. The length that a half vector rounds to errs by less than 16 u, and so does this.
inline AffineForm stretched_sin2_theta(const Vec3<AffineForm>& w, const AffineForm& alpha) {
  const AffineForm sin2 = sin2_theta(w), alpha2 = sqr(alpha);
  const AffineForm plain = sin2 + sqr(alpha * w.z);
  return narrower(plain, widened(alpha2 + (AffineForm(1) - alpha2) * sin2, 20 * 0x1p-24));
}

// (x / alpha_x)^2 + (y / alpha_y)^2 of a half vector (widths.hpp), where the map tells its slopes, also as
// r^2 cos^2 theta_h (a c^2 + b s^2), c^2 + s^2 = 1 of the azimuth; a = b where the map is as wide as the lobe.
inline AffineForm sin2_of_slopes(const ShadingGeometry<AffineForm>& g, const AffineForm& alpha_x,
                                 const AffineForm& alpha_y, const AffineForm& plain) {
  const HalfSlopes& h = g.slopes;
  if (!h.known) return plain;
  const AffineForm a = sqr(h.widths.x / alpha_x), b = sqr(h.widths.y / alpha_y);
  const double least = std::min(a.range.lo, b.range.lo), most = std::max(a.range.hi, b.range.hi);
  if (!(least > 0) || !(most < 100 * least)) return plain;
  const RealInterval ratio = alpha_x.range / alpha_y.range;
  const double off = 2e-6 * most / least + 4 * h.turn * std::max(ratio.hi, 1 / ratio.lo);
  const AffineForm c2 = sqr(h.azimuth.x), s2 = sqr(h.azimuth.y);
  const AffineForm around = narrower(narrower(a * c2 + b * s2, a + (b - a) * s2), b + (a - b) * c2);
  return narrower(plain, widened(sqr(h.r * g.wh.z) * around, off));
}

// The azimuth of wh where wo has none. wh is a sum of wo and wi with positive weights, so that its azimuth lies
// between theirs, 0 and that of wi, however little is known of wh about the normal. Where the two may point apart
// the sum is mended, and this is not said.
inline AffineForm between_azimuths(AffineForm azimuth_h, const ShadingGeometry<AffineForm>& g) {
  if (!g.azimuth_i || g.wo.y.range.magnitude() > 0 || g.wo.x.range.lo < 0) return azimuth_h;
  const RealInterval cosine = g.wo.x.range * g.wi.x.range + g.wo.z.range * g.wi.z.range,
                     i = g.azimuth_i->range;
  if (!(cosine.lo > 0.1)) return azimuth_h;
  constexpr double off = 2e-6;
  const RealInterval range = intersection(azimuth_h.range, hull({-off, off}, {i.lo - off, i.hi + off}));
  if (range.lo <= range.hi) azimuth_h.range = range;
  return azimuth_h;
}

// What encloses a function of three channels (a grey one has three that are equal): every value that it returns
// for a geometry of the box stands in the form.
class BrdfEnclosure {
 public:
  virtual ~BrdfEnclosure() = default;
  virtual RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const = 0;
  // f cos theta_i, up to 16 roundings, of functions that divide by the cosine.
  virtual std::optional<RgbT<AffineForm>> times_cosine(const ShadingGeometry<AffineForm>&) const {
    return std::nullopt;
  }
  // Of functions of more channels than three, of which operator() says nothing: what a target makes of f, or of
  // f cos theta_i.
  virtual bool reduces_channels() const { return false; }
  virtual AffineForm reduced(const Target&, const ShadingGeometry<AffineForm>&, bool /*times_cosine*/) const {
    return AffineForm::anything_in({0, detail::infinity});
  }
  // Whether the function returns the same, to the last bit, for wi and its image in the plane of wo, where wo
  // has no y: then one of the two is looked at.
  virtual bool is_mirror_symmetric() const { return false; }
  // Likewise where x and y of all directions are turned around, and where y alone is.
  virtual bool keeps_half_turns() const { return false; }
  virtual bool keeps_mirrored_axes() const { return false; }
};

// What a formula keeps, to the last bit.
struct ExactSymmetry {
  bool in_plane_of_wo = false, half_turns = false, mirrored_axes = false;
};
inline ExactSymmetry symmetry_of(const BrdfEnclosure& f) {
  return {f.is_mirror_symmetric(), f.keeps_half_turns(), f.keeps_mirrored_axes()};
}

// Likewise of a family, whose parameters are forms, too.
using ParameterForms = std::array<AffineForm, max_parameters>;
class FamilyEnclosure {
 public:
  virtual ~FamilyEnclosure() = default;
  virtual RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g,
                                      const ParameterForms& at) const = 0;
  // Of all members.
  virtual ExactSymmetry keeps() const { return {}; }
};

namespace detail {
template <class F>
class FormulaEnclosure final : public BrdfEnclosure {
 public:
  FormulaEnclosure(F f, ExactSymmetry keeps) : f_(std::move(f)), keeps_(keeps) {}
  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override { return f_(g); }
  bool is_mirror_symmetric() const override { return keeps_.in_plane_of_wo; }
  bool keeps_half_turns() const override { return keeps_.half_turns; }
  bool keeps_mirrored_axes() const override { return keeps_.mirrored_axes; }

 private:
  F f_;
  ExactSymmetry keeps_;
};
}  // namespace detail

// F, whose formula is a template on its scalar, telling of its own enclosure. Where it is isotropic it must be
// mirror-symmetric as well; `keeps` says what else it does.
template <class F>
struct Enclosed : F {
  ExactSymmetry keeps;
  Enclosed(F f, ExactSymmetry also_keeps = {}) : F(std::move(f)), keeps(also_keeps) {}
  BrdfTraits traits() const {
    BrdfTraits traits = F::traits();
    ExactSymmetry all = keeps;
    all.in_plane_of_wo = traits.isotropic_by_formula;
    traits.enclosure = std::make_shared<detail::FormulaEnclosure<F>>(static_cast<const F&>(*this), all);
    return traits;
  }
};

// What every registered model keeps (tests/sampler/enclosure_test.cpp holds them to it): of directions its formula
// takes squares and products alone, in the frame of its own axis.
template <class M>
ExactSymmetry symmetry_of_model(const M& model) {
  ExactSymmetry keeps{model.traits().isotropic_by_formula, true, true};
  if constexpr (requires { model.phi; }) keeps.mirrored_axes = model.phi.degrees == 0;
  return keeps;
}

}  // namespace reflectree
