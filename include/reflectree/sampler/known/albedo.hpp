// SPDX-License-Identifier: Apache-2.0
// a(wo) = integral of t cos_i over the hemisphere: the table that is stored, and the form that is looked up.
#pragma once

#include <vector>

#include "reflectree/sampler/known/cosine_lookup.hpp"

namespace reflectree {

// Piecewise linear in cos_theta_o.
struct AlbedoTable {
  std::vector<float> cos_theta_o;  // ascending, from the smallest served to 1
  std::vector<float> albedo;
  // Stated bound on the error of quadrature and interpolation up to 89.9 degrees; beyond, ten times as large.
  float relative_error = 0;
  friend bool operator==(const AlbedoTable&, const AlbedoTable&) = default;
};

// a(wo) by linear interpolation; 0 outside the table.
float albedo_at(const AlbedoTable& table, float cos_theta_o);
// Throws Error unless the nodes ascend over the hemisphere and every value is a number that is not negative.
void validate(const AlbedoTable& table);

struct AlbedoPiece {
  float base, slope;  // albedo = base + slope cos_theta_o
};

struct PackedAlbedo {
  CosineLookup lookup;
  std::vector<AlbedoPiece> pieces;

  float at(float cos_theta_o) const {
    const AlbedoPiece& piece = pieces[lookup(cos_theta_o)];
    return piece.base + piece.slope * cos_theta_o;
  }
  std::size_t bytes() const { return lookup.bytes() + pieces.size() * sizeof(AlbedoPiece); }
};
PackedAlbedo pack(const AlbedoTable& table);

}  // namespace reflectree
