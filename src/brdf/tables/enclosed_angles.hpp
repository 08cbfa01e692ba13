// SPDX-License-Identifier: Apache-2.0
// The angles of fast_functions.hpp over boxes.
#pragma once

#include "reflectree/math/affine_form.hpp"

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

}  // namespace reflectree::enclosed_angles
