// SPDX-License-Identifier: Apache-2.0
// 4 x 4 matrices that act on columns.
#pragma once

#include <array>
#include <cmath>

#include "reflectree/render/scene.hpp"

namespace reflectree::render {

using Matrix = std::array<std::array<double, 4>, 4>;

inline constexpr Matrix identity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

inline Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix m{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k < 4; ++k) m[i][j] += a[i][k] * b[k][j];
    }
  }
  return m;
}

// w = 1: a point; 0: a vector.
inline Vec3<double> apply_double(const Matrix& m, Vec3<double> p, double w) {
  const auto row = [&](std::size_t i) { return m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z + m[i][3] * w; };
  return {row(0), row(1), row(2)};
}
inline Point to_float(Vec3<double> p) { return {float(p.x), float(p.y), float(p.z)}; }
inline Point apply(const Matrix& m, Vec3<double> p, double w) { return to_float(apply_double(m, p, w)); }

// A normal: by the cofactors, the transposed inverse times the determinant, so that mirrors turn it too. Not
// of unit length.
inline Direction apply_to_normal(const Matrix& m, Direction n) {
  const auto column = [&](std::size_t j) { return Vec3<double>{m[0][j], m[1][j], m[2][j]}; };
  const auto a = column(0), b = column(1), c = column(2);
  const double side = dot(cross(a, b), c) < 0 ? -1 : 1;
  const auto sum = double(n.x) * cross(b, c) + double(n.y) * cross(c, a) + double(n.z) * cross(a, b);
  const double size = length(sum);
  return size > 0 ? to_float((side / size) * sum) : Direction{};
}

}  // namespace reflectree::render
