// SPDX-License-Identifier: Apache-2.0
// What the tables of RGL files share: positions on grids over [0, 1], and the masses of a warp.
#pragma once

#include <algorithm>
#include <vector>

#include "reflectree/math/scalar.hpp"

namespace reflectree::rgl_parts {

// A position on a grid of `size` nodes over [0, 1]: the node below and the fraction towards the next.
struct GridPosition {
  int node;
  float fraction;
};
inline GridPosition locate(float u, int size) {
  const float x = min(max(0.f, u), 1.f) * float(size - 1);  // in this order a NaN becomes 0
  const int node = std::min(int(x), size - 2);
  return {node, x - float(node)};
}

inline float interpolate(const std::vector<float>& table, float u) {
  const GridPosition p = locate(u, int(table.size()));
  const float* node = table.data() + p.node;
  return linear_mix(p.fraction, node[0], node[1]);
}

inline float elevation_to_u(float theta) { return sqrt(theta * (2.f / pi)); }

// One slice of the warp, scaled to unit mass: cumulative trapezoids along u, then along v (the density is
// bilinear between nodes).
struct Slice {
  std::vector<double> pdf, cdf, row_mass, row_cdf;
};
inline Slice integrate(const float* density, int width, int height) {
  const auto w = std::size_t(width), h = std::size_t(height);
  Slice s;
  s.pdf.resize(w * h), s.cdf.resize(w * h), s.row_mass.resize(h), s.row_cdf.resize(h);
  for (std::size_t y = 0; y < h; ++y) {
    for (std::size_t x = 0; x < w; ++x) {
      const std::size_t i = y * w + x;
      s.pdf[i] = double(density[i]);
      s.cdf[i] = x == 0 ? 0 : s.cdf[i - 1] + 0.5 * (s.pdf[i - 1] + s.pdf[i]);
    }
    s.row_mass[y] = s.cdf[y * w + w - 1];
    s.row_cdf[y] = y == 0 ? 0 : s.row_cdf[y - 1] + 0.5 * (s.row_mass[y - 1] + s.row_mass[y]);
  }
  const double total = s.row_cdf.back(), scale = total > 0 ? 1 / total : 0;
  for (auto* table : {&s.pdf, &s.cdf, &s.row_mass, &s.row_cdf}) {
    for (double& v : *table) v *= scale;
  }
  return s;
}

}  // namespace reflectree::rgl_parts
