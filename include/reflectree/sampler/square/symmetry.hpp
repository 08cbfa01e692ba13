// SPDX-License-Identifier: Apache-2.0
// What a tree need not store twice.
#pragma once

#include <cstdint>

#include "reflectree/math/direction.hpp"

namespace reflectree {

// none: the square's y runs over [-1, 1], with the sign of the azimuth. mirror: f is the same for wi and its
// image in the plane of incidence, so that y in [0, 1] serves both, with a coin for the sign of wi.y.
enum class Symmetry : std::uint8_t { none, mirror };

// A box in square coordinates.
struct SquareCell {
  float x0, x1, y0, y1;
};
constexpr SquareCell root_cell(Symmetry symmetry) {
  return {-1, 1, symmetry == Symmetry::mirror ? 0.f : -1.f, 1};
}
// The area of the whole square in its coordinates; a cell's share is its area over this.
constexpr float root_area(Symmetry symmetry) { return symmetry == Symmetry::mirror ? 2.f : 4.f; }
inline double share_of(const SquareCell& c, Symmetry symmetry) {
  return double(c.x1 - c.x0) * double(c.y1 - c.y0) / double(root_area(symmetry));
}

// The point at shares u and v of the whole square, in [0, 1].
constexpr Vec2<float> square_point(Symmetry symmetry, float u, float v) {
  return {2 * u - 1, symmetry == Symmetry::mirror ? v : 2 * v - 1};
}

// Of wi and its images the one that the square knows.
REFLECTREE_INLINE Direction fold(Symmetry symmetry, Direction wi) {
  return {wi.x, symmetry == Symmetry::mirror ? abs(wi.y) : wi.y, wi.z};
}

}  // namespace reflectree
