// SPDX-License-Identifier: Apache-2.0
// The elementary densities that renderers mix, and their mixtures, constant or tabulated over theta_o.
// Directions below the horizon are lost samples: a lobe's pdf integrates to 1 minus their rate.
#pragma once

#include <vector>

#include "reflectree/brdf/models/widths.hpp"
#include "reflectree/peers/density.hpp"

namespace reflectree {

enum class LobeKind : std::uint8_t {
  uniform,      // 1 / (2 pi)
  cosine,       // cos_i / pi; the same as uniform over the projected disk
  power,        // (n + 1) / (2 pi) cos^n about normalize(axis * wo), by components; n = a
  ggx,          // visible normals of GGX, widths a, b; spherical caps, Dupuy and Benyoub 2023
  ggx_bounded,  // the same without most normals whose reflection is lost; Tokuyoshi and Eto 2024
  gaussian,     // half vectors with Gaussian slopes of widths a, b; Walter 2005 for Ward's lobe, and with
                // a = b Beckmann's D cos_theta_h
  half_power,   // half vectors of Ashikhmin and Shirley 2000, exponents a, b
};

struct ProposalLobe {
  LobeKind kind = LobeKind::cosine;
  float a = 1, b = 1;
  Vec3<float> axis{-1, -1, 1};
  Azimuth phi = {};  // of the lobe's own x axis

  std::optional<Direction> sample(Direction wo, UniformBits& u) const;
  float pdf(Direction wo, Direction wi) const;

 private:
  bool is_ggx() const { return kind == LobeKind::ggx || kind == LobeKind::ggx_bounded; }
  std::optional<Direction> sample_own(Direction wo, UniformBits& u) const;  // in its own frame
  float pdf_own(Direction wo, Direction wi) const;
};

struct WeightedLobe {
  float weight = 1;
  ProposalLobe lobe;
};

// rows[i] serves the elevations of wo nearest to (i + 1/2) / rows.size() of a right angle. Weights of a row
// sum to 1.
struct LobeMixture {
  std::vector<std::vector<WeightedLobe>> rows;

  std::optional<DrawnFromDensity> sample(Direction wo, UniformBits& u) const;
  float pdf(Direction wo, Direction wi) const;
  std::size_t bytes() const;
  const std::vector<WeightedLobe>& row(Direction wo) const;
};

// One row, its weights normalised.
LobeMixture lobe_mixture(std::vector<WeightedLobe> lobes);
inline double row_theta_o(std::size_t row, std::size_t rows) {
  return (double(row) + 0.5) / double(rows) * pi_v<double> / 2;
}

}  // namespace reflectree
