// SPDX-License-Identifier: Apache-2.0
// A density over the unit square, bilinear between the nodes of a grid, with its cumulative tables: the
// marginal along y, and along x in every row of nodes. Being linear in the nodes they may be blended, and the
// blend inverted; so may both ways of the map from uniform points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reflectree/math/direction.hpp"
#include "reflectree/math/uniform_bits.hpp"

namespace reflectree {

class BilinearTable {
 public:
  // nodes[y * width + x] >= 0, not all zero; scaled here to integral 1.
  BilinearTable(std::span<const float> nodes, int width, int height);

  struct Pair {
    const BilinearTable &a, &b;  // of equal size
    float t = 0;                 // share of b

    Vec2<float> sample(UniformBits& u) const;
    Vec2<float> warp(double u, double v) const;
    Vec2<double> unwarp(Vec2<float> p) const;  // the inverse of warp
    float pdf(Vec2<float> p) const;
  };
  int width() const { return width_; }
  int height() const { return height_; }
  float node(int x, int y) const { return node_[index(x, y)]; }
  std::size_t bytes() const;

 private:
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width_) + std::size_t(x); }
  int width_, height_;
  std::vector<float> node_, cdf_;     // [y][x]; cdf along x up to the node
  std::vector<float> row_, row_cdf_;  // [y]: integral along x; integral of that along y
};

// The same density, its cells chosen by Walker's alias method (1977; Vose 1991): constant time, not monotone.
class AliasTable {
 public:
  AliasTable(std::span<const float> nodes, int width, int height);

  Vec2<float> sample(UniformBits& u) const;
  float pdf(Vec2<float> p) const;
  std::size_t bytes() const;

 private:
  struct Cell {
    std::uint32_t threshold, other;  // keep this cell below the threshold
  };
  int width_, height_;
  std::vector<float> node_;
  std::vector<Cell> cells_;
};

}  // namespace reflectree
