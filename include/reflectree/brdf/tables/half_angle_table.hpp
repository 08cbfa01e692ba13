// SPDX-License-Identifier: Apache-2.0
// An isotropic BRDF tabulated over half-angle coordinates (theta_h, theta_d, phi_d), finer in theta_h
// towards the mirror direction. With 90 x 90 x 180 cells it is a material of the MERL database: Matusik et
// al. 2003, "A Data-Driven Reflectance Model".
#pragma once

#include <span>
#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/math/half_angle.hpp"

namespace reflectree {

enum class TableLookup {
  nearest,  // the cell that holds the pair, as MERL's own reader does: piecewise constant
  linear,   // trilinear between the centres of measured cells; phi_d wraps
};

// f(wo, wi) in sr^-1, Rgb. Cell (h, d, p) spans, in units of its index,
//   n_h sqrt(theta_h / (pi/2)), n_d theta_d / (pi/2), n_p phi_d / period,
// where period is pi for a reciprocal table and 2 pi otherwise.
//
// A negative entry says that nothing was measured there: it is a mark, no value, and is never mixed with one.
// `nearest` reads it as 0. `linear` leaves it out and gives its weight to the measured corners of the cell;
// where there is none it reads 0.
struct HalfAngleTable {
  std::string name = "table";
  int n_h = 0, n_d = 0, n_p = 0;
  bool reciprocal = true;
  TableLookup lookup = TableLookup::nearest;
  std::vector<float> rgb;  // [h][d][p][3]; negative: not measured

  Rgb operator()(const ShadingGeometry<float>& g) const;
  // Many at once, channel by channel, 0 below the surface: their cells are on their way from memory together.
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<float> out) const;
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const;
  // The share of f(wo, wi) that would come from entries that were not measured: 0 to 1 for each channel.
  Rgb unmeasured(const ShadingGeometry<float>& g) const;
  BrdfTraits traits() const;
};

// With the enclosure of the table: of all entries that a look-up may touch over a box of directions.
AnyBrdf enclosed(HalfAngleTable table);

// Where a cell is baked: its centre, pulled towards theta_d = 0 where the centre has a direction below
// the horizon, so that cells which the horizon cuts hold a value of the part above. phi_h = 0.
DirectionPair<float> cell_centre(const HalfAngleTable& table, int h, int d, int p);

}  // namespace reflectree
