// SPDX-License-Identifier: Apache-2.0
// What Beckmann's distribution needs of the error function.
#pragma once

#include "reflectree/math/scalar.hpp"

namespace reflectree::render {

inline constexpr float inverse_root_pi = .564189584f;

// erfc(x) exp(x^2) for x = over / under >= 0; erfc's error is below 1.5e-7 (Abramowitz & Stegun 1964, 7.1.26).
inline float scaled_erfc(float over, float under = 1) {
  const float t = under / (under + .3275911f * over);
  return t * (.254829592f + t * (-.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f))));
}

float inverse_erf(float x);

// A visible slope x along wo, in units of alpha: its density goes as max(0, cos - x sin) exp(-x^2). `u`: the
// share of it below x. Only the ratio of `cosine` and `sine` counts.
float visible_slope(float cosine, float sine, float u);

}  // namespace reflectree::render
