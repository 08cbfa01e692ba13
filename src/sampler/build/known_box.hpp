// SPDX-License-Identifier: Apache-2.0
// A viewer by its known coordinates, and boxes of them.
#pragma once

#include <array>

#include "reflectree/math/fast_functions.hpp"
#include "reflectree/sampler/known/cosine_lookup.hpp"
#include "reflectree/sampler/known/parameter.hpp"

namespace reflectree::detail {

// theta_o, phi_o in the viewer's frame (0 for isotropic functions), and the coordinates of a family's
// parameters (parameter.hpp; 0 where there are none).
inline constexpr std::size_t known_slots = 2 + max_parameters;
using Known = std::array<float, known_slots>;
// Shares of a box, in [0, 1], along each of its axes.
using Shares = std::array<float, known_slots>;

struct KnownBox {
  Known lo{}, hi{};
  int axes = 1;  // how many of the coordinates are known: all others are 0
  std::array<std::uint8_t, known_slots> slot{0, 1, 2, 3};  // which coordinate an axis is
  float width(int axis) const {
    const auto k = std::size_t(slot[std::size_t(axis)]);
    return hi[k] - lo[k];
  }
  // The point at shares of the box.
  Known at(const Shares& share) const {
    Known known{linear_mix(share[0], lo[0], hi[0])};  // theta_o comes first
    for (int a = 1; a < axes; ++a) {
      const auto k = std::size_t(slot[std::size_t(a)]);
      known[k] = linear_mix(share[std::size_t(a)], lo[k], hi[k]);
    }
    return known;
  }
  Shares share_of(const Known& known) const {
    Shares share{};
    for (int a = 0; a < axes; ++a) {
      const auto k = std::size_t(slot[std::size_t(a)]);
      share[std::size_t(a)] = (known[k] - lo[k]) / (hi[k] - lo[k]);
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
// A direction in the viewer's frame and, of families, the coordinates of the parameters.
struct Viewer {
  Direction wo;
  Coordinates at = {};
};
inline Viewer viewer_at(const Known& known) {
  return {turned_to(wo_from_cosine(clamp(cos(known[0]), min_cos_theta_o, 1.f)), known[1]),
          {known[2], known[3]}};
}
// phi_o in [0, 2 pi).
inline float azimuth_of(Direction wo) {
  const float phi = angle_of(wo.y, wo.x);
  return phi < 0 ? phi + 2 * pi : phi;
}
inline float theta_of_viewer(Direction wo) { return acos(min(wo.z, 1.f)); }

// The known coordinates of a viewer.
inline Known known_of(const Viewer& viewer, const KnownBox& box) {
  const bool azimuth = box.axes > 1 && box.slot[1] == 1;
  return {theta_of_viewer(viewer.wo), azimuth ? azimuth_of(viewer.wo) : 0.f, viewer.at[0], viewer.at[1]};
}

}  // namespace reflectree::detail
