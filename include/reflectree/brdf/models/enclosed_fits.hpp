// SPDX-License-Identifier: Apache-2.0
// The published fits over boxes: of two steps what their forms would lose towards grazing.
#pragma once

#include "reflectree/brdf/enclosure.hpp"
#include "reflectree/brdf/models/abc.hpp"
#include "reflectree/brdf/models/cook_torrance.hpp"
#include "reflectree/brdf/models/sgd.hpp"

namespace reflectree {

// min(co, ci) / (co ci) as 1 / max(co, ci). The program rounds 8 times, the forms do so as well.
inline AffineForm abc_shadowed(const AffineForm& x, const ShadingGeometry<AffineForm>& g) {
  return widened(x * (AffineForm(4 / pi_v<double>) * v_cavity_visibility(g)), 16 * 0x1p-24);
}

// The program computes the masking of SGD in double, and towards grazing it is a small number that is divided
// by a cosine as small: a form that rounds the elevation to float would say nothing there. So beside the angle,
// for elevations near the normal, the cosine.
struct EnclosedElevation {
  AffineForm theta, cosine;
};
template <>
struct SgdElevation<AffineForm> {
  using Angle = EnclosedElevation;
};
inline EnclosedElevation sgd_elevation(const Vec3<AffineForm>& w) {
  return {atan2(sqrt(sin2_theta(w)), w.z), widened(w.z, 2 * length_tolerance)};
}

// G of the cosine v ascends; g(v) = g(m) + (v - m) g'(V) for v, m in V, by intervals of double. What the
// program's doubles round is less than 2^-50 in theta, and less than some units of the exponent's terms, which
// the two exponentials multiply by 81 at most.
inline AffineForm sgd_masking(const SgdChannel& c, const EnclosedElevation& elevation) {
  const AffineForm& v = elevation.cosine;
  const RealInterval cosine = intersection(v.range, {0, 1}), most(4.4f), least(-80.f);
  if (!(cosine.lo <= cosine.hi) || cosine.hi > 0.9) return sgd_masking<AffineForm>(c, elevation.theta);
  const auto angle = [](RealInterval x) { return acos(x) + RealInterval(-0x1p-50, 0x1p-50); };
  const RealInterval theta = angle(cosine), x = max(theta - RealInterval(c.theta_0), RealInterval(1e-30f));
  const RealInterval exponent = RealInterval(c.log_c) + RealInterval(c.k) * log(x);
  const double terms = exponent.hi < -81 ? 0 : std::abs(double(c.log_c)) + double(c.k) * log(x).magnitude();
  const double slack = (1 + double(c.lambda)) * (1 + terms) * 81 * 0x1p-50;
  const auto masking_at = [&](double at) {
    const RealInterval g = sgd_uncut_masking(c, angle(RealInterval(at, at)));
    return RealInterval(g.lo - slack, g.hi + slack);
  };
  const RealInterval range{masking_at(cosine.lo).lo, masking_at(cosine.hi).hi};
  // g' = lambda e^p p k / (x sin theta), 0 where p is kept.
  const RealInterval kept = max(min(exponent, most), least);
  RealInterval slope =
      RealInterval(c.lambda) * exp(exp(kept)) * exp(kept) * RealInterval(c.k) / (x * sin(theta));
  if (exponent.hi >= most.lo || exponent.lo <= least.hi) slope.lo = 0;
  AffineForm g = AffineForm::anything_in(range);
  if (slope.hi < detail::largest_double) {
    const double alpha = slope.middle(), middle = cosine.middle();
    const RealInterval rest = masking_at(middle) +
                              (slope - RealInterval(alpha)) * (cosine - RealInterval(middle)) -
                              RealInterval(alpha) * RealInterval(middle);
    g = linear_enclosure(v, alpha, rest, range);
  }
  return widened(clamp(g, AffineForm(0), AffineForm(1)), 0x1.0001p-24);
}

}  // namespace reflectree
