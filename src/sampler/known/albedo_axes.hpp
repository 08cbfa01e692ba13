// SPDX-License-Identifier: Apache-2.0
// Rows of the albedo's table along its axes, azimuth and parameters: which stand for a place, and with what
// weight; and what stands for a row beyond an end.
#pragma once

#include <algorithm>
#include <array>

#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

// What stands for a row beyond an end: of a single segment the mirrored one, or, of a whole period, the one
// that comes round; of several the polynomial goes on.
struct Beyond {
  std::array<std::size_t, 4> row{};
  std::array<float, 4> weight{};
};
Beyond row_at(const AlbedoTable& table, const AlbedoSegment& segment, std::ptrdiff_t k);

// Four rows along an axis with their weights; of a single row, it alone.
struct RowsOfAxis {
  std::array<std::ptrdiff_t, 4> row{};
  std::array<float, 4> weight{1, 0, 0, 0};
  std::size_t count = 1;
};
inline RowsOfAxis rows_at(const AlbedoAxis& axis, float at) {
  RowsOfAxis r;
  const float x = clamp((at - axis.lo) / (axis.hi - axis.lo), 0.f, 1.f) * float(axis.rows - 1);
  const std::size_t k = std::min(std::size_t(x), std::size_t(axis.rows) - 2);
  r.weight = cubic_weights(x - float(k)), r.count = 4;
  for (std::size_t i = 0; i < 4; ++i) r.row[i] = std::ptrdiff_t(k + i) - 1;
  return r;
}

// How many rows the azimuths have with one more at both ends of each segment.
inline std::size_t padded_rows(const std::vector<float>& azimuths,
                               const std::vector<AlbedoSegment>& segments) {
  return azimuths.size() + 2 * segments.size();
}

// The rows of the azimuth phi_o in a segment whose first row, with the one before it, is `first`.
inline RowsOfAxis rows_of_azimuth(std::size_t first, std::size_t rows, float x) {
  RowsOfAxis r = rows_at({0, float(rows - 1), std::uint32_t(rows)}, x);
  for (auto& row : r.row) row += std::ptrdiff_t(first) + 1;
  return r;
}

// The sum over the rows of all axes: weight * value(row), where rows count from the first one that is there,
// beyond the ends; of the azimuths `azimuth` knows them, and `azimuths` how many there are.
template <class Value>
float over_rows(const std::vector<AlbedoAxis>& parameters, const RowsOfAxis& azimuth, std::size_t azimuths,
                const Coordinates& at, const Value& value) {
  std::array<RowsOfAxis, 1 + max_parameters> axes{azimuth};
  std::array<std::size_t, 1 + max_parameters> stride{1, 1, 1};
  std::size_t rows = azimuths;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    axes[1 + p] = rows_at(parameters[p], at[p]);
    for (auto& row : axes[1 + p].row) ++row;
    stride[1 + p] = rows;
    rows *= parameters[p].rows + 2;
  }
  float sum = 0;
  for (std::size_t b = 0; b < axes[2].count; ++b) {
    for (std::size_t a = 0; a < axes[1].count; ++a) {
      for (std::size_t k = 0; k < axes[0].count; ++k) {
        const std::size_t row = std::size_t(axes[2].row[b]) * stride[2] +
                                std::size_t(axes[1].row[a]) * stride[1] + std::size_t(axes[0].row[k]);
        sum += axes[2].weight[b] * axes[1].weight[a] * axes[0].weight[k] * value(row);
      }
    }
  }
  return max(sum, 0.f);
}

}  // namespace reflectree::detail
