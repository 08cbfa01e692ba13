// SPDX-License-Identifier: Apache-2.0
// The angles of fast_functions.hpp over boxes, and azimuths that go round.
#pragma once

#include "reflectree/brdf/enclosure.hpp"

namespace reflectree::enclosed_angles {

// What the polynomials are off, relative.
inline constexpr double angle_share = 4e-7;

inline AffineForm within(AffineForm x, double lo, double hi) {
  x.range = {std::clamp(x.range.lo, lo, hi), std::clamp(x.range.hi, lo, hi)};
  return x;
}

inline AffineForm polar_angle(const AffineForm& sine, const AffineForm& cosine) {
  return within(widened(atan2(sine, cosine), angle_share), 0, 0.5 * pi_v<double> * (1 + angle_share));
}
// In [0, pi], of y >= 0.
inline AffineForm angle_above(const AffineForm& y, const AffineForm& x) {
  const AffineForm angle = x.range.hi < 0 ? AffineForm(pi_v<double>) - atan2(y, -x) : atan2(y, x);
  return within(widened(angle, angle_share), 0, pi_v<double> * (1 + angle_share));
}

// In [-pi, pi].
inline AffineForm azimuth_of(const AffineForm& y, const AffineForm& x) {
  if (y.range.lo >= 0) return angle_above(y, x);
  if (y.range.hi < 0) return -angle_above(-y, x);
  if (x.range.lo > 0) return widened(atan2(y, x), angle_share);
  return AffineForm::anything_in({-pi_v<double> * (1 + angle_share), pi_v<double> * (1 + angle_share)});
}

inline AffineForm sin_theta_o(const ShadingGeometry<AffineForm>& g) {
  if (g.viewer) return g.viewer->sin_theta_o;
  return g.wo.y.range.magnitude() == 0 && g.wo.x.range.lo >= 0 ? g.wo.x : sqrt(sin2_theta(g.wo));
}
// Azimuths in the frame of g, of any branch.
inline AffineForm azimuth_of_wo(const ShadingGeometry<AffineForm>& g) {
  return g.viewer ? g.viewer->azimuth : azimuth_of(g.wo.y, g.wo.x);
}
inline AffineForm azimuth_of_wh(const ShadingGeometry<AffineForm>& g) {
  return g.viewer && g.viewer->azimuth_h ? *g.viewer->azimuth_h : azimuth_of(g.wh.y, g.wh.x);
}

inline AffineForm shifted(const AffineForm& x, double by) {
  return linear_enclosure(x, 1, {by, by}, {x.range.lo + by, x.range.hi + by});
}
// Of a direction whose x, or y, is turned around.
inline AffineForm flipped(const AffineForm& azimuth, bool x, bool y) {
  const AffineForm by_y = x == y ? azimuth : -azimuth;
  return x ? shifted(by_y, pi_v<double>) : by_y;
}
// An azimuth as floats tell it.
inline AffineForm rounded_angle(const AffineForm& angle) {
  return widened(angle, angle_share) + AffineForm::anything_in({-5e-7, 5e-7});
}
// visit(form): what lies in `span` of the branches of an angle, but for parts less than `least` wide.
template <class Visit>
void for_each_branch(const AffineForm& angle, RealInterval span, double least, const Visit& visit) {
  constexpr double turn = 2 * pi_v<double>, tiny = 1e-9;
  const auto first = int(std::ceil((span.lo - angle.range.hi) / turn - tiny));
  const auto last = int(std::floor((span.hi - angle.range.lo) / turn + tiny));
  if (angle.range.hi - angle.range.lo < 4 * least) least = 0;
  for (int k = first; k <= last; ++k) {
    const AffineForm branch = k == 0 ? angle : shifted(angle, turn * k);
    const double wide = std::min(branch.range.hi, span.hi) - std::max(branch.range.lo, span.lo);
    if (first == last || wide >= least || least == 0) visit(within(branch, span.lo, span.hi));
  }
}

}  // namespace reflectree::enclosed_angles
