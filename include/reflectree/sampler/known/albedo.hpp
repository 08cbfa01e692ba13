// SPDX-License-Identifier: Apache-2.0
// a(wo) = integral of t cos_i over the hemisphere: the table that is stored, and the form that is looked up.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
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

// Piecewise linear in cos_theta_o. Of anisotropic functions rows at azimuths of the viewer, in segments: in
// each the rows are equidistant, and between two of them lies the cubic through four (where there are as
// many). The next segment begins where one ends, with a row of its own, so that what leaps there has both its
// sides. Of families cubic in the coordinate of each parameter, too.
struct AlbedoTable {
  std::vector<float> cos_theta_o;  // ascending, from the smallest served to 1
  std::vector<float> albedo;       // [second parameter][first parameter][phi_o][cos_theta_o]
  // Stated bound on the error of quadrature and interpolation up to 89.9 degrees; beyond, ten times as large.
  float relative_error = 0;
  // The same as prove_albedo() proved it; 0: not proved.
  float proved_error = 0;
  // From 0 to azimuth_span, radians; empty for isotropic functions.
  std::vector<float> phi_o = {};
  bool even = false;                        // of a single segment: mirrored about both ends; else periodic
  std::vector<AlbedoAxis> parameters = {};  // of families
  friend bool operator==(const AlbedoTable&, const AlbedoTable&) = default;
};

// a(wo) by linear interpolation; 0 outside the table.
float albedo_at(const AlbedoTable& table, float cos_theta_o);
// The same where many are asked for: a guide to the nodes of the table, made once.
CosineLookup guide_to(const AlbedoTable& table);
float albedo_at(const AlbedoTable& table, const CosineLookup& guide, float cos_theta_o);
float albedo_at(const AlbedoTable& table, float cos_theta_o, float phi_o);
float albedo_at(const AlbedoTable& table, float cos_theta_o, float phi_o, const Coordinates& at);
// Throws Error unless the nodes ascend over the hemisphere and every value is a number that is not negative.
void validate(const AlbedoTable& table);

// Rows of equal distance.
struct AlbedoSegment {
  std::size_t first, rows;
};
std::vector<AlbedoSegment> segments_of(const AlbedoTable& table);

struct AlbedoPiece {
  float base, slope;  // albedo = base + slope cos_theta_o
};

// The weights of four equidistant values at -1, 0, 1, 2 in the cubic through them, at t in [0, 1].
template <class T>
REFLECTREE_INLINE std::array<T, 4> cubic_weights(T t) {
  const T a = t + T(1), b = t - T(1), c = t - T(2);
  return {-t * b * c / T(6), a * b * c / T(2), -a * t * c / T(2), a * t * b / T(6)};
}

struct PackedAlbedo {
  CosineLookup lookup;
  struct Segment {
    float phi_o, rows_per_radian;
    std::uint32_t first, last;  // the row before the segment's first one; the last that a cubic begins at
  };
  // Equidistant rows along a family's parameter, with one more at both ends.
  struct Axis {
    float lo, rows_per_unit;
    std::uint32_t rows;
    std::size_t stride;  // pieces from row to row
  };
  // [cos_theta_o][second parameter][first parameter][phi_o], every segment and parameter with a row more at both
  // ends: rows that are summed lie side by side.
  std::vector<AlbedoPiece> pieces;
  std::size_t row = 0;            // pieces of one cos_theta_o
  std::vector<Segment> segments;  // empty for isotropic functions
  std::vector<float> keys = {};   // of the azimuths where they begin
  std::vector<Axis> parameters = {};
  // Of one coordinate beyond theta_o: known to be 0 nowhere, so that who does not need it need not ask.
  bool positive = false;

  float at(float cos_theta_o) const {
    const AlbedoPiece& piece = pieces[lookup(cos_theta_o)];
    return piece.base + piece.slope * cos_theta_o;
  }
  // phi_o in [0, azimuth_span].
  float at(float cos_theta_o, float phi_o) const {
    const Row first = row_at(phi_o);
    return max(cubic(pieces_at(cos_theta_o) + first.index, cubic_weights(first.t), cos_theta_o), 0.f);
  }
  // Where a cubic over the azimuth begins: the first of its four rows, and t in [0, 1].
  struct Row {
    std::size_t index;
    float t;
  };
  Row row_at(float phi_o) const {
    const Segment& segment = segments.size() == 1 ? segments.front() : segment_at(phi_o);
    const float x = max((phi_o - segment.phi_o) * segment.rows_per_radian, 0.f);
    const auto k = std::uint32_t(min(x, float(segment.last)));
    return {segment.first + k, x - float(k)};
  }
  // All rows of one cos_theta_o.
  const AlbedoPiece* pieces_at(float cos_theta_o) const { return pieces.data() + row * lookup(cos_theta_o); }
  const Segment& segment_at(float phi_o) const;
  // phi_o on the side of the segments' borders on which its azimuth_key stands: by keys slabs are found, too, and
  // functions with a step at a border may ask it.
  float on_side(float phi_o, float key) const {
    return keys.size() > 1 ? between_borders(phi_o, key) : phi_o;
  }
  float between_borders(float phi_o, float key) const;
  // Of families.
  float at(float cos_theta_o, float phi_o, const Coordinates& at) const {
    const AlbedoPiece* column = pieces_at(cos_theta_o);
    if (parameters.size() > 1 || !segments.empty())
      return max(over_rows(column, cos_theta_o, phi_o, at), 0.f);
    const Place place = place_at(parameters.front(), at[0]);
    return max(cubic(column + place.first, place.weights, cos_theta_o), 0.f);
  }
  // The four rows about a coordinate, by the first of them.
  struct Place {
    std::size_t first;
    std::array<float, 4> weights;
  };
  static Place place_at(const Axis& axis, float at) {
    const float x = clamp((at - axis.lo) * axis.rows_per_unit, 0.f, float(axis.rows - 1));
    const std::size_t k = std::min(std::size_t(x), std::size_t(axis.rows - 2));
    return {k * axis.stride, cubic_weights(x - float(k))};
  }
  // Over four pieces side by side.
  static float cubic(const AlbedoPiece* piece, const std::array<float, 4>& weights, float c) {
    float sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += weights[i] * (piece[i].base + piece[i].slope * c);
    return sum;
  }
  float over_rows(const AlbedoPiece* column, float cos_theta_o, float phi_o, const Coordinates& at) const;
  std::size_t bytes() const {
    return lookup.bytes() + pieces.size() * sizeof(AlbedoPiece) + segments.size() * sizeof(Segment) +
           keys.size() * sizeof(float);
  }
};
PackedAlbedo pack(const AlbedoTable& table);

}  // namespace reflectree
