// SPDX-License-Identifier: Apache-2.0
// What the tables of RGL files share: positions on grids over [0, 1], and the masses of a warp.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "reflectree/brdf/shading_geometry.hpp"
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

// Many look-ups side by side, since the tables are larger than the cache: up to `block` pairs go through a stage
// before the next begins. dark(i): a pair below the surface. known(g): what depends on wo alone, shared by pairs
// in a row that share wo. in_warp(known, g) and in_colour(known, in_warp) prefetch what the next stage reads;
// finish(i, known, in_warp, in_colour) writes the value.
template <std::size_t block, class Dark, class Known, class InWarp, class InColour, class Finish>
void look_up(std::span<const ShadingGeometry<float>> geometry, const Dark& dark, const Known& known,
             const InWarp& in_warp, const InColour& in_colour, const Finish& finish) {
  using OfWo = decltype(known(geometry[0]));
  using AtWarp = decltype(in_warp(std::declval<OfWo>(), geometry[0]));
  struct Pair {
    std::size_t i;
    OfWo of_wo;
    AtWarp warp;
    decltype(in_colour(std::declval<OfWo>(), std::declval<AtWarp>())) colour;
  } pairs[block];
  for (std::size_t begin = 0; begin < geometry.size(); begin += block) {
    const std::size_t end = std::min(begin + block, geometry.size());
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const ShadingGeometry<float>& g = geometry[i];
      if (!(g.cos_theta_o > 0 && g.cos_theta_i > 0)) {
        dark(i);
        continue;
      }
      Pair& p = pairs[count];
      const bool same = count > 0 && geometry[pairs[count - 1].i].wo == g.wo;
      p.i = i, p.of_wo = same ? pairs[count - 1].of_wo : known(g), p.warp = in_warp(p.of_wo, g);
      ++count;
    }
    for (Pair& p : std::span(pairs, count)) p.colour = in_colour(p.of_wo, p.warp);
    for (const Pair& p : std::span(pairs, count)) finish(p.i, p.of_wo, p.warp, p.colour);
  }
}

inline std::vector<ShadingGeometry<float>> shading_geometries(std::span<const Direction> wo,
                                                              std::span<const Direction> wi) {
  std::vector<ShadingGeometry<float>> geometry;
  for (std::size_t i = 0; i < wo.size(); ++i) geometry.push_back(shading_geometry(wo[i], wi[i]));
  return geometry;
}

}  // namespace reflectree::rgl_parts
