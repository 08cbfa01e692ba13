// SPDX-License-Identifier: Apache-2.0
// Points of the unit circle, by turns, without branches (quarters of random turns are a toss-up) or a call.
#pragma once

#include "reflectree/math/direction.hpp"

namespace reflectree {

// {cos, sin} of 2 pi `turns`, 0 <= turns <= 1; error < 1.2e-7. Whole quarters are taken off without rounding;
// what is left, |x| <= pi/4, enters polynomials with the coefficients of Moshier's Cephes, sinf.
inline Vec2<float> on_circle(float turns) {
  const int quarters = int(4 * turns + .5f);
  const float x = 2 * pi * (turns - .25f * float(quarters)), x2 = x * x;
  const float sine = x + x * x2 * (-.166666546f + x2 * (.00833216087f - x2 * .000195152959f));
  const float cosine = 1 + x2 * (-.5f + x2 * (.0416666457f + x2 * (-.00138873163f + x2 * 2.44331571e-05f)));
  const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v); };
  const auto signed_by = [](std::uint32_t v, int two) {
    return std::bit_cast<float>(v ^ (std::uint32_t(two & 2) << 30U));
  };
  const std::uint32_t swap = (bits(sine) ^ bits(cosine)) & (0U - std::uint32_t(quarters & 1));
  return {signed_by(bits(cosine) ^ swap, quarters + 1), signed_by(bits(sine) ^ swap, quarters)};
}

}  // namespace reflectree
