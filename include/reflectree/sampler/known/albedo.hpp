// SPDX-License-Identifier: Apache-2.0
// a(wo) = integral of t cos_i over the hemisphere: the table that is stored, and the form that is looked up.
#pragma once

#include <algorithm>
#include <vector>

#include "reflectree/sampler/known/cosine_lookup.hpp"

namespace reflectree {

// Piecewise linear in cos_theta_o and, of anisotropic functions, in phi_o.
struct AlbedoTable {
  std::vector<float> cos_theta_o;  // ascending, from the smallest served to 1
  std::vector<float> albedo;       // [phi_o][cos_theta_o]
  // Stated bound on the error of quadrature and interpolation up to 89.9 degrees; beyond, ten times as large.
  float relative_error = 0;
  // Equidistant azimuths of the viewer from 0 to azimuth_span, radians; empty for isotropic functions.
  std::vector<float> phi_o = {};
  friend bool operator==(const AlbedoTable&, const AlbedoTable&) = default;
};

// a(wo) by linear interpolation; 0 outside the table.
float albedo_at(const AlbedoTable& table, float cos_theta_o);
float albedo_at(const AlbedoTable& table, float cos_theta_o, float phi_o);
// Throws Error unless the nodes ascend over the hemisphere and every value is a number that is not negative.
void validate(const AlbedoTable& table);

struct AlbedoPiece {
  float base, slope;  // albedo = base + slope cos_theta_o
};

struct PackedAlbedo {
  CosineLookup lookup;
  std::vector<AlbedoPiece> pieces;  // [phi_o][cos_theta_o]
  std::size_t row = 0;              // pieces of one azimuth
  float azimuths_per_radian = 0;    // 0 for isotropic functions

  float at(float cos_theta_o) const {
    const AlbedoPiece& piece = pieces[lookup(cos_theta_o)];
    return piece.base + piece.slope * cos_theta_o;
  }
  // phi_o in [0, azimuth_span].
  float at(float cos_theta_o, float phi_o) const {
    const std::size_t i = lookup(cos_theta_o), rows = pieces.size() / row;
    const float x = phi_o * azimuths_per_radian;
    const std::size_t k = x > 0 ? std::min(std::size_t(x), rows - 2) : 0;
    const AlbedoPiece &a = pieces[k * row + i], &b = pieces[(k + 1) * row + i];
    const float here = a.base + a.slope * cos_theta_o, next = b.base + b.slope * cos_theta_o;
    return here + (next - here) * (x - float(k));
  }
  std::size_t bytes() const { return lookup.bytes() + pieces.size() * sizeof(AlbedoPiece); }
};
PackedAlbedo pack(const AlbedoTable& table);

}  // namespace reflectree
