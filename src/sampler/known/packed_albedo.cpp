// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "albedo_axes.hpp"
#include "reflectree/math/azimuth_key.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree {

using namespace detail;

namespace {

// A row more at both ends of the axis in the middle, on the cubic through the four rows there.
std::vector<float> with_ends(const std::vector<float>& values, std::size_t rows, std::size_t inner) {
  const std::size_t outer = values.size() / (rows * inner);
  std::vector<float> out(outer * (rows + 2) * inner);
  for (std::size_t o = 0; o < outer; ++o) {
    const float* from = values.data() + o * rows * inner;
    float* to = out.data() + o * (rows + 2) * inner;
    std::copy_n(from, rows * inner, to + inner);
    for (std::size_t i = 0; i < inner; ++i) {
      const auto beyond = [&](std::size_t first, std::ptrdiff_t step) {
        const auto at = [&](std::ptrdiff_t k) {
          return double(from[std::size_t(std::ptrdiff_t(first) + k * step) * inner + i]);
        };
        return float(4 * at(0) - 6 * at(1) + 4 * at(2) - at(3));
      };
      to[i] = beyond(0, 1), to[(rows + 1) * inner + i] = beyond(rows - 1, -1);
    }
  }
  return out;
}

// The same where the axis is the azimuth, whose rows beyond the ends of a segment are told by row_at.
std::vector<float> with_azimuths(const AlbedoTable& table, const std::vector<float>& values) {
  const std::size_t rows = table.phi_o.size(), inner = table.cos_theta_o.size(),
                    outer = values.size() / (rows * inner);
  const std::vector<AlbedoSegment> segments = segments_of(table);
  std::vector<float> out;
  for (std::size_t o = 0; o < outer; ++o) {
    const float* from = values.data() + o * rows * inner;
    for (const AlbedoSegment& segment : segments) {
      for (std::ptrdiff_t k = -1; k <= std::ptrdiff_t(segment.rows); ++k) {
        const Beyond b = row_at(table, segment, k);
        for (std::size_t i = 0; i < inner; ++i) {
          float value = 0;
          for (std::size_t m = 0; m < 4; ++m) value += b.weight[m] * from[b.row[m] * inner + i];
          out.push_back(value);
        }
      }
    }
  }
  return out;
}
// All values of a table with the rows beyond the ends of every axis.
std::vector<float> padded(const AlbedoTable& table) {
  std::vector<float> values = table.albedo;
  std::size_t inner = table.cos_theta_o.size();
  if (!table.phi_o.empty()) {
    values = with_azimuths(table, values);
    inner *= padded_rows(table.phi_o, segments_of(table));
  }
  for (const AlbedoAxis& axis : table.parameters) {
    values = with_ends(values, axis.rows, inner);
    inner *= axis.rows + 2;
  }
  return values;
}

// The lines between the nodes of a row; of an azimuth where there are several, all of which meet at the normal.
void pack_row(const std::vector<float>& cosines, const float* albedo, bool of_azimuth,
              std::vector<AlbedoPiece>& pieces) {
  for (std::size_t i = 0; i + 1 < cosines.size(); ++i) {
    const double c0 = double(cosines[i]), c1 = double(cosines[i + 1]);
    const double a0 = double(albedo[i]), a1 = double(albedo[i + 1]);
    // Between neighbouring floats lies nothing; a line through both sides of a jump would lose every digit.
    // The last line holds its upper end, too. That is not the normal alone, but all who are nearer to it than a float
    // tells: with an azimuth of theirs, whose value is that of the neighbour.
    const bool neighbours =
        (i + 2 < cosines.size() || of_azimuth) && std::nextafter(cosines[i], 2.f) >= cosines[i + 1];
    const double slope = neighbours ? 0 : (a1 - a0) / (c1 - c0);
    pieces.push_back({float(a0 - slope * c0), float(slope)});
  }
}

// Whether cubics through four rows, one after another, are above 0 wherever they are looked up: their negative
// weights, t (1 - t) / 2 in all, are at most 1/8. At nodes is enough, since lines lead from node to node.
bool is_positive(const std::vector<float>& values, std::size_t columns) {
  for (std::size_t i = 0; i + 3 * columns < values.size(); ++i) {
    const auto [low, high] =
        std::minmax({values[i], values[i + columns], values[i + 2 * columns], values[i + 3 * columns]});
    if (!(low - 0.126f * (high - low) > 1e-4f * high)) return false;
  }
  return true;
}

}  // namespace

float PackedAlbedo::over_rows(const AlbedoPiece* column, float cos_theta_o, float phi_o,
                              const Coordinates& at) const {
  const Place first = place_at(parameters[0], at[0]);
  const bool two = parameters.size() > 1;
  const Place second = two ? place_at(parameters[1], at[1]) : Place{0, {1}};
  std::size_t azimuth = 0;
  std::array<float, 4> azimuths{};
  if (!segments.empty()) {
    const Row begin = row_at(phi_o);
    azimuth = begin.index, azimuths = cubic_weights(begin.t);
  }
  float sum = 0;
  for (std::size_t b = 0; b < (two ? 4 : 1); ++b) {
    const AlbedoPiece* rows = column + second.first + (two ? b * parameters[1].stride : 0) + first.first;
    if (segments.empty()) {
      sum += second.weights[b] * cubic(rows, first.weights, cos_theta_o);
      continue;
    }
    for (std::size_t a = 0; a < 4; ++a) {
      const AlbedoPiece* side_by_side = rows + a * parameters[0].stride + azimuth;
      sum += second.weights[b] * first.weights[a] * cubic(side_by_side, azimuths, cos_theta_o);
    }
  }
  return sum;
}

const PackedAlbedo::Segment& PackedAlbedo::segment_at(float phi_o) const {
  const auto after = std::upper_bound(segments.begin() + 1, segments.end(), phi_o,
                                      [](float phi, const Segment& s) { return phi < s.phi_o; });
  return *(after - 1);
}

float PackedAlbedo::between_borders(float phi_o, float key) const {
  const auto next = std::upper_bound(keys.begin() + 1, keys.end(), key) - keys.begin();
  const auto k = std::size_t(next - 1);
  phi_o = max(phi_o, segments[k].phi_o);
  return k + 1 < segments.size() ? min(phi_o, std::nextafter(segments[k + 1].phi_o, 0.f)) : phi_o;
}

PackedAlbedo pack(const AlbedoTable& table) {
  const std::size_t columns = table.cos_theta_o.size();
  PackedAlbedo packed{CosineLookup(table.cos_theta_o), {}, columns - 1, {}};
  std::size_t rows = 0;
  for (const AlbedoSegment& segment : segments_of(table)) {
    const float begin = table.phi_o[segment.first], end = table.phi_o[segment.first + segment.rows - 1];
    packed.segments.push_back({begin, float(segment.rows - 1) / (end - begin), std::uint32_t(rows),
                               std::uint32_t(segment.rows - 2)});
    packed.keys.push_back(azimuth_key(begin));
    rows += segment.rows + 2;
  }
  const std::vector<float> values = padded(table);
  for (std::size_t first = 0; first < values.size(); first += columns)
    pack_row(table.cos_theta_o, values.data() + first, rows > 0, packed.pieces);
  packed.positive = table.parameters.size() + (rows > 0) == 1 && is_positive(values, columns);
  rows = std::max<std::size_t>(rows, 1);
  for (const AlbedoAxis& axis : table.parameters) {
    packed.parameters.push_back({axis.lo, float(axis.rows - 1) / (axis.hi - axis.lo), axis.rows, rows});
    rows *= axis.rows + 2;
  }
  const std::vector<AlbedoPiece> by_row = std::exchange(packed.pieces, {});
  packed.row = rows;
  for (std::size_t column = 0; column + 1 < columns; ++column) {
    for (std::size_t row = 0; row < rows; ++row)
      packed.pieces.push_back(by_row[row * (columns - 1) + column]);
  }
  return packed;
}

}  // namespace reflectree
