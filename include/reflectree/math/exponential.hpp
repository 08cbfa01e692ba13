// SPDX-License-Identifier: Apache-2.0
// e^x in line, without a library call.
#pragma once

#include "reflectree/math/scalar.hpp"

namespace reflectree {

// e^x for x <= 0; relative error < 1.5e-7. Powers of two are taken off in two parts (Cody & Waite 1980), the
// rest, |r| <= log(2)/2, enters the polynomial of Moshier's Cephes, expf.
inline float exp_of_negative(float x) {
  if (!(x > -87)) return std::exp(x);  // below the normal numbers
  const int n = int(1.44269504f * x - .5f);
  const float r = (x - float(n) * .693359375f) + float(n) * 2.12194440e-4f, r2 = r * r;
  const float low = .5f + r * .166666655f, high = .0416657959f + r * .00833345191f;
  const float p = low + r2 * (high + r2 * (.00139819995f + r * .000198756915f));
  return (1 + (r + r2 * p)) * std::bit_cast<float>(std::uint32_t(n + 127) << 23U);
}

}  // namespace reflectree
