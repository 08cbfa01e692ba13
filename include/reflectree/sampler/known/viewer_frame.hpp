// SPDX-License-Identifier: Apache-2.0
// The frame in which a sampler knows its viewers: isotropic functions know theta_o alone; all others also the
// azimuth phi_o, from an axis of the material on, folded by the symmetries that the function has.
#pragma once

#include <cstdint>

#include "reflectree/math/direction.hpp"

namespace reflectree {

// What leaves f(wo, wi) as it is, done to both directions at once.
enum class ViewerSymmetry : std::uint8_t {
  isotropic,   // every turn about the normal
  two_planes,  // mirroring x and mirroring y: phi_o in [0, pi/2]
  one_plane,   // mirroring y: phi_o in [0, pi]
  half_turn,   // turning by pi: phi_o in [0, pi]
  none         // phi_o in [0, 2 pi]
};
const char* name_of(ViewerSymmetry symmetry);

constexpr bool is_mirrored(ViewerSymmetry symmetry) {
  return symmetry == ViewerSymmetry::two_planes || symmetry == ViewerSymmetry::one_plane;
}

struct ViewerFrame {
  ViewerSymmetry symmetry = ViewerSymmetry::isotropic;
  float axis = 0;  // radians: the azimuth of the frame's x axis in the caller's frame
  bool isotropic() const { return symmetry == ViewerSymmetry::isotropic; }
  friend bool operator==(const ViewerFrame&, const ViewerFrame&) = default;
};

// How far phi_o reaches, radians; 0 for isotropic functions.
float azimuth_span(ViewerSymmetry symmetry);

// w turned about the normal by the angle of a cosine and a sine.
REFLECTREE_INLINE Direction turn(Direction w, float cosine, float sine) {
  return {w.x * cosine - w.y * sine, w.x * sine + w.y * cosine, w.z};
}

}  // namespace reflectree
