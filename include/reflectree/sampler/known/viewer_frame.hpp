// SPDX-License-Identifier: Apache-2.0
// The frame in which a sampler knows its viewers: isotropic functions know theta_o alone; all others also the
// azimuth phi_o, from an axis of the material on, folded by the symmetries that the function has.
#pragma once

#include <cstdint>

#include "reflectree/math/azimuth_key.hpp"
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

// A viewer's direction along the surface in the frame of the axis, folded, and the way back: y turned around by
// the sign bit of `side`, then a turn by the angle of a cosine and a sine.
template <class T>
struct FoldedViewer {
  T x, y, cosine, sine, side;
};
// Of floats or lanes; by sign bits, since branches would be coin tosses.
template <class T>
REFLECTREE_INLINE FoldedViewer<T> fold_viewer(ViewerSymmetry symmetry, T x, T y, T cosine, T sine) {
  T u = x * cosine + y * sine, v = y * cosine - x * sine;
  T half_turn(0), side(0);  // by sign bits; -0 is 0
  switch (symmetry) {
    case ViewerSymmetry::two_planes:  // mirroring x is mirroring y and half a turn
      half_turn = u + T(0), side = flip_sign(v, half_turn) + T(0);
      u = abs(u), v = abs(v);
      break;
    case ViewerSymmetry::one_plane:
      side = v + T(0), v = abs(v);
      break;
    case ViewerSymmetry::half_turn:
      half_turn = v + T(0), u = flip_sign(u, half_turn), v = abs(v);
      break;
    default:
      break;
  }
  return {u, v, flip_sign(cosine, half_turn), flip_sign(sine, half_turn), side};
}

// By what slabs are found: the azimuth_key of a folded viewer.
template <class T>
REFLECTREE_INLINE T azimuth_key(ViewerSymmetry symmetry, T x, T y) {
  if (symmetry != ViewerSymmetry::two_planes) return azimuth_key(x, y);
  const T a = abs(x), b = abs(y);
  return b / max(a + b, T(1e-37f));
}

}  // namespace reflectree
