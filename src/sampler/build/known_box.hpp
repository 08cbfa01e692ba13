// SPDX-License-Identifier: Apache-2.0
// A viewer by its known coordinates, and boxes of them.
#pragma once

#include <array>

#include "reflectree/math/fast_functions.hpp"
#include "reflectree/sampler/known/cosine_lookup.hpp"

namespace reflectree::detail {

// theta_o and, of anisotropic functions, phi_o in the viewer's frame; radians.
using Known = std::array<float, 2>;

struct KnownBox {
  Known lo{}, hi{};
  int axes = 1;  // how many of the coordinates are known: all others are 0
  float width(int axis) const { return hi[std::size_t(axis)] - lo[std::size_t(axis)]; }
  // The point at shares of the box, each in [0, 1].
  Known at(const Known& share) const {
    Known known{};
    for (int a = 0; a < axes; ++a) {
      const auto k = std::size_t(a);
      known[k] = linear_mix(share[k], lo[k], hi[k]);
    }
    return known;
  }
  Known share_of(const Known& known) const {
    Known share{};
    for (int a = 0; a < axes; ++a) {
      const auto k = std::size_t(a);
      share[k] = (known[k] - lo[k]) / (hi[k] - lo[k]);
    }
    return share;
  }
};

inline constexpr float theta_max = 1.5707887f;  // cos = min_cos_theta_o, rounded outwards

inline Direction wo_from_cosine(float cos_theta_o) {
  return {sqrt(max((1 - cos_theta_o) * (1 + cos_theta_o), 0.f)), 0, cos_theta_o};
}
inline Direction turned_to(Direction wo, float phi_o) {
  if (phi_o == 0) return wo;
  return {wo.x * cos(phi_o), wo.x * sin(phi_o), wo.z};
}
inline Direction viewer_at(const Known& known) {
  return turned_to(wo_from_cosine(clamp(cos(known[0]), min_cos_theta_o, 1.f)), known[1]);
}
// phi_o in [0, 2 pi).
inline float azimuth_of(Direction wo) {
  const float phi = angle_of(wo.y, wo.x);
  return phi < 0 ? phi + 2 * pi : phi;
}
inline float theta_of_viewer(Direction wo) { return acos(min(wo.z, 1.f)); }

}  // namespace reflectree::detail
