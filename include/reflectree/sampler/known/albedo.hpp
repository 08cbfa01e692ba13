// SPDX-License-Identifier: Apache-2.0
// a(wo) = integral of t cos_i over the hemisphere: the table that is stored, and the form that is looked up.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "reflectree/math/scalar.hpp"
#include "reflectree/sampler/known/cosine_lookup.hpp"
#include "reflectree/sampler/known/parameter.hpp"

namespace reflectree {

// Equidistant places along the coordinate of a parameter, both ends included.
struct AlbedoAxis {
  float lo = 0, hi = 1;
  std::uint32_t rows = 4;
  friend bool operator==(const AlbedoAxis&, const AlbedoAxis&) = default;
};

// Piecewise linear in cos_theta_o; of anisotropic functions cubic in phi_o, of families in the coordinate of
// each parameter, through four rows.
struct AlbedoTable {
  std::vector<float> cos_theta_o;  // ascending, from the smallest served to 1
  std::vector<float> albedo;       // [second parameter][first parameter][phi_o][cos_theta_o]
  // Stated bound on the error of quadrature and interpolation up to 89.9 degrees; beyond, ten times as large.
  float relative_error = 0;
  // Equidistant azimuths of the viewer from 0 to azimuth_span, radians; empty for isotropic functions.
  std::vector<float> phi_o = {};
  bool even = false;                        // in phi_o about both ends, by mirror planes; else periodic
  std::vector<AlbedoAxis> parameters = {};  // of families
  friend bool operator==(const AlbedoTable&, const AlbedoTable&) = default;
};

// a(wo) by linear interpolation; 0 outside the table.
float albedo_at(const AlbedoTable& table, float cos_theta_o);
float albedo_at(const AlbedoTable& table, float cos_theta_o, float phi_o);
float albedo_at(const AlbedoTable& table, float cos_theta_o, float phi_o, const Coordinates& at);
// Throws Error unless the nodes ascend over the hemisphere and every value is a number that is not negative.
void validate(const AlbedoTable& table);

struct AlbedoPiece {
  float base, slope;  // albedo = base + slope cos_theta_o
};

// The weights of four equidistant values at -1, 0, 1, 2 in the cubic through them, at t in [0, 1].
REFLECTREE_INLINE std::array<float, 4> cubic_weights(float t) {
  const float a = t + 1, b = t - 1, c = t - 2;
  return {-t * b * c / 6, a * b * c / 2, -a * t * c / 2, a * t * b / 6};
}

struct PackedAlbedo {
  CosineLookup lookup;
  // [phi_o][cos_theta_o]; of anisotropic functions with a row more at both ends.
  std::vector<AlbedoPiece> pieces;
  std::size_t row = 0;            // pieces of one azimuth
  float azimuths_per_radian = 0;  // 0 for isotropic functions
  // Of families, whose pieces have a row more at both ends of each of these, too.
  std::vector<AlbedoAxis> parameters = {};

  float at(float cos_theta_o) const {
    const AlbedoPiece& piece = pieces[lookup(cos_theta_o)];
    return piece.base + piece.slope * cos_theta_o;
  }
  // phi_o in [0, azimuth_span].
  float at(float cos_theta_o, float phi_o) const {
    const std::size_t last = pieces.size() / row - 4;
    const float x = max(phi_o * azimuths_per_radian, 0.f);
    const std::size_t k = std::min(std::size_t(x), last);
    const std::array<float, 4> weights = cubic_weights(x - float(k));
    const AlbedoPiece* piece = pieces.data() + k * row + lookup(cos_theta_o);
    float sum = 0;
    for (std::size_t i = 0; i < 4; ++i, piece += row)
      sum += weights[i] * (piece->base + piece->slope * cos_theta_o);
    return max(sum, 0.f);
  }
  // Of families.
  float at(float cos_theta_o, float phi_o, const Coordinates& at) const;
  std::size_t bytes() const { return lookup.bytes() + pieces.size() * sizeof(AlbedoPiece); }
};
PackedAlbedo pack(const AlbedoTable& table);

}  // namespace reflectree
