// SPDX-License-Identifier: Apache-2.0
// The difference vector over a box of directions (difference_vector.hpp), written so that the forms stay narrow.
#pragma once

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/brdf/tables/difference_vector.hpp"

namespace reflectree::detail {

// sin theta_h, and cosine and sine of phi_h, as the float formula divides them.
struct HalfFrame {
  AffineForm sin_theta_h;
  Vec2<AffineForm> azimuth;
};
inline HalfFrame half_frame(const ShadingGeometry<AffineForm>& g) {
  constexpr double share = 8 * 0x1p-24;  // of itself, what both formulas round
  HalfFrame out{sqrt(sin2_theta(g.wh)), {}};
  AffineForm &sin_h = out.sin_theta_h, &x = out.azimuth.x, &y = out.azimuth.y;
  if (const HalfAzimuth* known = known_azimuth(g)) {
    x = widened(known->cosine, share), y = widened(known->sine, share);
    const AffineForm along = known->cosine * g.wh.x + known->sine * g.wh.y;
    sin_h = narrower(sin_h, widened(abs(along), share));
  } else if (sin_h.range.lo > 1e-12) {
    x = widened(g.wh.x / sin_h, share), y = widened(g.wh.y / sin_h, share);
  } else {
    x = y = AffineForm::anything_in(RealInterval::whole());
  }
  for (AffineForm* v : {&x, &y}) {
    const RealInterval known = intersection(v->range, {-1 - share, 1 + share});
    if (v->error < 1) {
      v->range = known;
    } else {
      *v = AffineForm::anything_in(known);
    }
  }
  return out;
}

// wo is wi mirrored in wh, and so d.x and d.y are those of wo with the other sign: wo + wi has less than
// 4 length_tolerance that is not along wh (sum_of_directions, in enclosure.hpp; elsewhere 20 u), of which half
// enters, and the float formula rounds by less than 8 u.
inline Difference<AffineForm> difference_vector(const ShadingGeometry<AffineForm>& g,
                                                const HalfFrame& frame) {
  const AffineForm off = AffineForm::anything_in({-3 * length_tolerance, 3 * length_tolerance});
  const AffineForm &cosine = frame.azimuth.x, &sine = frame.azimuth.y;
  const AffineForm x = frame.sin_theta_h * g.wo.z - g.cos_theta_h * (cosine * g.wo.x + sine * g.wo.y);
  return {frame.sin_theta_h, {x + off, sine * g.wo.x - cosine * g.wo.y + off, g.cos_theta_d}};
}

// f(frame), forms of three channels, where wh is about the normal and its azimuth may be any: arc by arc, so that
// cosine and sine stay those of one azimuth.
template <class F>
RgbT<AffineForm> by_azimuth(HalfFrame frame, const F& f) {
  const Vec2<AffineForm> all = frame.azimuth;
  if (std::max(all.x.error, all.y.error) < 0.1) return f(frame);
  constexpr int arcs = 32;
  constexpr double off = 1e-6;
  const auto wider = [](RealInterval r) { return RealInterval(r.lo - off, r.hi + off); };
  RgbT<AffineForm> hull_of;
  bool any = false;
  for (int k = 0; k < arcs; ++k) {
    const RealInterval arc{2 * pi_v<double> * k / arcs, 2 * pi_v<double> * (k + 1) / arcs};
    const RealInterval x = intersection(wider(cos(arc)), all.x.range);
    const RealInterval y = intersection(wider(sin(arc)), all.y.range);
    if (x.lo > x.hi || y.lo > y.hi) continue;
    frame.azimuth = {AffineForm::anything_in(x), AffineForm::anything_in(y)};
    const RgbT<AffineForm> v = f(frame);
    const auto add = [any](AffineForm& sum, const AffineForm& form) {
      sum = any ? AffineForm::anything_in(hull(sum.range, form.range)) : form;
    };
    add(hull_of.r, v.r), add(hull_of.g, v.g), add(hull_of.b, v.b);
    any = true;
  }
  return any ? hull_of : f({frame.sin_theta_h, all});
}

}  // namespace reflectree::detail
