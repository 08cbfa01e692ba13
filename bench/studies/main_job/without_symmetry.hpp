// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "reflectree/brdf/value.hpp"
#include "reflectree/math/direction.hpp"

namespace reflectree::study {

// Two lobes that are turned against each other, and a lopsided one: nothing to fold.
inline Rgb without_symmetry(Direction wo, Direction wi) {
  const Direction h = normalize(wo + wi);
  const auto lobe = [&](float phi, float ax, float ay) {
    const float c = std::cos(phi), s = std::sin(phi), x = (c * h.x + s * h.y) / ax,
                y = (c * h.y - s * h.x) / ay;
    return std::exp(-(x * x + y * y) / (h.z * h.z));
  };
  const float ground = 0.1f + 0.05f * wi.x;
  return ground * Rgb{1, 0.7f, 0.4f} + 0.5f * lobe(0.4f, 0.15f, 0.5f) * Rgb{1, 1, 1} +
         0.3f * lobe(1.5f, 0.4f, 0.2f) * Rgb{0.4f, 0.6f, 1};
}

}  // namespace reflectree::study
