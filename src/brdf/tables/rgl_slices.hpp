// SPDX-License-Identifier: Apache-2.0
// What the enclosure of RGL tables reads of them, whatever their layout. A slice is a node of the known direction: with
// n nodes of theta_o, node p of phi_o and t of theta_o are slice p n + t; isotropic tables have one phi_o.
#pragma once

#include <algorithm>

#include "reflectree/brdf/tables/rgl_table.hpp"
#include "reflectree/brdf/tables/rgl_wide_table.hpp"

namespace reflectree {

struct WarpPoint {
  double cdf, pdf;  // integral along u up to the node; density at the node
};
struct WarpLine {
  double cdf, mass;  // integral along v up to the row; integral along the row
};
// Nodes of a table: [y][x].
struct GridSize {
  int width, height;
};
struct SquareNodes {
  GridSize size;
  const float* values;
};

template <class Table>
struct RglSlices;

template <>
struct RglSlices<RglTable> {
  RglTable t;

  const std::vector<float>& theta_o() const { return t.theta_o_; }
  GridSize warp_size() const { return {t.warp_width_, t.warp_height_}; }
  GridSize colour_size() const { return {t.colour_width_, t.colour_height_}; }
  int channels() const { return 3; }
  SquareNodes sigma() const { return {{int(t.sigma_.size()), 1}, t.sigma_.data()}; }
  SquareNodes ndf() const { return {{int(t.ndf_.size()), 1}, t.ndf_.data()}; }

  WarpPoint warp(int slice, int y, int x) const {
    const RglTable::WarpNode& n = t.warp_[at(slice, warp_size(), y, x)];
    return {double(n.cdf[side(slice)]), double(n.pdf[side(slice)])};
  }
  WarpLine row(int slice, int y) const {
    const RglTable::WarpRow& r = t.rows_[at(slice, {1, t.warp_height_}, y, 0)];
    return {double(r.cdf[side(slice)]), double(r.mass[side(slice)])};
  }
  // One float per channel.
  const float* colour(int slice, int y, int x) const {
    return t.colour_[at(slice, colour_size(), y, x)].rgb[side(slice)];
  }

 private:
  int pair(int slice) const { return std::min(slice, int(t.theta_o_.size()) - 2); }
  std::size_t side(int slice) const { return std::size_t(slice - pair(slice)); }
  std::size_t at(int slice, GridSize size, int y, int x) const {
    return (std::size_t(pair(slice)) * std::size_t(size.height) + std::size_t(y)) * std::size_t(size.width) +
           std::size_t(x);
  }
};

template <>
struct RglSlices<RglWideTable> {
  RglWideTable t;

  const std::vector<float>& theta_o() const { return t.theta_o_; }
  const std::vector<float>& phi_o() const { return t.phi_o_; }
  int reduction() const { return t.reduction_; }
  GridSize warp_size() const { return {t.warp_width_, t.warp_height_}; }
  GridSize colour_size() const { return {t.colour_width_, t.colour_height_}; }
  int channels() const { return t.channels_; }
  SquareNodes sigma() const { return nodes_of(t.sigma_); }
  SquareNodes ndf() const { return nodes_of(t.ndf_); }

  WarpPoint warp(int slice, int y, int x) const {
    const RglWideTable::WarpNode& n = t.warp_[at(slice, warp_size(), y, x)];
    return {double(n.cdf), double(n.pdf)};
  }
  WarpLine row(int slice, int y) const {
    const RglWideTable::WarpRow& r = t.row_[at(slice, {1, t.warp_height_}, y, 0)];
    return {double(r.cdf), double(r.mass)};
  }
  const float* colour(int slice, int y, int x) const {
    return t.colour_ + at(slice, colour_size(), y, x) * t.stride_;
  }

 private:
  static SquareNodes nodes_of(const RglSquare& s) { return {{s.width, s.height}, s.values.data()}; }
  static std::size_t at(int slice, GridSize size, int y, int x) {
    return (std::size_t(slice) * std::size_t(size.height) + std::size_t(y)) * std::size_t(size.width) +
           std::size_t(x);
  }
};

}  // namespace reflectree
