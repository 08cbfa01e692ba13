// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/albedo.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/math/scalar.hpp"

namespace reflectree {

namespace {

// The last node up to c, by halving without a branch: random cosines would mispredict it.
std::size_t node_before(const std::vector<float>& x, float c) {
  std::size_t i = 0;
  for (std::size_t count = x.size() - 1; count > 1;) {
    const std::size_t half = count / 2;
    i += x[i + half] <= c ? half : 0;
    count -= half;
  }
  return i;
}

// The row that stands for one beyond an end: the mirrored one, or, of a whole period, the one that comes
// round.
std::size_t row_beyond(const AlbedoTable& table, std::ptrdiff_t k) {
  const auto last = std::ptrdiff_t(table.phi_o.size()) - 1;
  if (k < 0) k = table.even ? -k : k + last;
  if (k > last) k = table.even ? 2 * last - k : k - last;
  return std::size_t(k);
}

bool is_outside(const std::vector<float>& x, float c) {
  return x.empty() || !(c >= x.front()) || c > x.back();
}

}  // namespace

float albedo_at(const AlbedoTable& table, float c) {
  const auto& x = table.cos_theta_o;
  if (is_outside(x, c)) return 0;
  const std::size_t i = node_before(x, c);
  const float t = (c - x[i]) / (x[i + 1] - x[i]);
  return linear_mix(t, table.albedo[i], table.albedo[i + 1]);
}

float albedo_at(const AlbedoTable& table, float c, float phi_o) {
  if (table.phi_o.empty()) return albedo_at(table, c);
  const auto& x = table.cos_theta_o;
  if (is_outside(x, c)) return 0;
  const std::size_t i = node_before(x, c), rows = table.phi_o.size();
  const float t = (c - x[i]) / (x[i + 1] - x[i]);
  const float at = clamp(phi_o / table.phi_o.back(), 0.f, 1.f) * float(rows - 1);
  const std::size_t k = std::min(std::size_t(at), rows - 2);
  const std::array<float, 4> weights = cubic_weights(at - float(k));
  float sum = 0;
  for (int n = -1; n <= 2; ++n) {
    const float* row = table.albedo.data() + row_beyond(table, std::ptrdiff_t(k) + n) * x.size() + i;
    sum += weights[std::size_t(n + 1)] * linear_mix(t, row[0], row[1]);
  }
  return max(sum, 0.f);
}

namespace {

// Four rows along an axis with their weights; of a single row, it alone.
struct RowsOfAxis {
  std::array<std::ptrdiff_t, 4> row{};
  std::array<float, 4> weight{1, 0, 0, 0};
  std::size_t count = 1;
};
RowsOfAxis rows_at(const AlbedoAxis& axis, float at) {
  RowsOfAxis r;
  const float x = clamp((at - axis.lo) / (axis.hi - axis.lo), 0.f, 1.f) * float(axis.rows - 1);
  const std::size_t k = std::min(std::size_t(x), std::size_t(axis.rows) - 2);
  r.weight = cubic_weights(x - float(k)), r.count = 4;
  for (std::size_t i = 0; i < 4; ++i) r.row[i] = std::ptrdiff_t(k + i) - 1;
  return r;
}

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

// The same where the axis is the azimuth, whose rows beyond the ends are rows of the table.
std::vector<float> with_azimuths(const AlbedoTable& table, const std::vector<float>& values) {
  const std::size_t rows = table.phi_o.size(), inner = table.cos_theta_o.size(),
                    outer = values.size() / (rows * inner);
  std::vector<float> out;
  for (std::size_t o = 0; o < outer; ++o) {
    for (std::ptrdiff_t k = -1; k <= std::ptrdiff_t(rows); ++k) {
      const float* row = values.data() + (o * rows + row_beyond(table, k)) * inner;
      out.insert(out.end(), row, row + inner);
    }
  }
  return out;
}

// All values of a family's table with the rows beyond the ends of every axis.
std::vector<float> padded(const AlbedoTable& table) {
  std::vector<float> values = table.albedo;
  std::size_t inner = table.cos_theta_o.size();
  if (!table.phi_o.empty()) {
    values = with_azimuths(table, values);
    inner *= table.phi_o.size() + 2;
  }
  for (const AlbedoAxis& axis : table.parameters) {
    values = with_ends(values, axis.rows, inner);
    inner *= axis.rows + 2;
  }
  return values;
}

// The sum over the rows of all axes: weight * value(row), where rows count from the first one that is there,
// beyond the ends.
template <class Value>
float over_rows(const std::vector<AlbedoAxis>& parameters, std::size_t azimuths, float azimuth,
                const Coordinates& at, const Value& value) {
  std::array<RowsOfAxis, 1 + max_parameters> axes;
  std::array<std::size_t, 1 + max_parameters> stride{1, 1, 1};
  std::size_t rows = 1;
  if (azimuths > 0) {
    axes[0] = rows_at({0, 1, std::uint32_t(azimuths)}, azimuth);
    for (auto& row : axes[0].row) ++row;
    rows *= azimuths + 2;
  }
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

// A value of the table of which `row` counts rows with those beyond the ends.
float padded_value(const AlbedoTable& table, std::size_t row, std::size_t column) {
  const std::size_t columns = table.cos_theta_o.size();
  // From the innermost axis outwards.
  std::size_t inner = 0, stride = 1;
  if (!table.phi_o.empty()) {
    const std::size_t rows = table.phi_o.size() + 2;
    inner = row_beyond(table, std::ptrdiff_t(row % rows) - 1), stride = table.phi_o.size();
    row /= rows;
  }
  // Beyond the ends of a parameter lies the cubic through the four rows there.
  const auto value = [&](const auto& self, std::size_t axis, std::size_t rest, std::size_t at,
                         std::size_t step) -> double {
    if (axis == table.parameters.size()) return double(table.albedo[at * columns + column]);
    const std::size_t rows = table.parameters[axis].rows, k = rest % (rows + 2), outer = rest / (rows + 2);
    const auto inside = [&](std::size_t n) {
      return self(self, axis + 1, outer, at + n * step, step * rows);
    };
    if (k > 0 && k <= rows) return inside(k - 1);
    const std::size_t first = k == 0 ? 0 : rows - 1;
    const auto next = [&](std::size_t n) { return inside(k == 0 ? first + n : first - n); };
    return 4 * next(0) - 6 * next(1) + 4 * next(2) - next(3);
  };
  return float(value(value, 0, row, inner, stride));
}

}  // namespace

float albedo_at(const AlbedoTable& table, float c, float phi_o, const Coordinates& at) {
  if (table.parameters.empty()) return albedo_at(table, c, phi_o);
  const auto& x = table.cos_theta_o;
  if (is_outside(x, c)) return 0;
  const std::size_t i = node_before(x, c);
  const float t = (c - x[i]) / (x[i + 1] - x[i]);
  const float azimuth = table.phi_o.empty() ? 0 : phi_o / table.phi_o.back();
  return over_rows(table.parameters, table.phi_o.size(), azimuth, at, [&](std::size_t row) {
    return linear_mix(t, padded_value(table, row, i), padded_value(table, row, i + 1));
  });
}

float PackedAlbedo::at(float cos_theta_o, float phi_o, const Coordinates& at) const {
  std::size_t azimuths = 0;
  float azimuth = 0;
  if (azimuths_per_radian > 0) {
    std::size_t rows = pieces.size() / row;
    for (const AlbedoAxis& axis : parameters) rows /= axis.rows + 2;
    azimuths = rows - 2;
    azimuth = phi_o * azimuths_per_radian / float(azimuths - 1);
  }
  const AlbedoPiece* column = pieces.data() + lookup(cos_theta_o);
  return over_rows(parameters, azimuths, azimuth, at, [&](std::size_t r) {
    const AlbedoPiece& piece = column[r * row];
    return piece.base + piece.slope * cos_theta_o;
  });
}

void validate(const AlbedoTable& a) {
  const auto fail = [](const char* what) { throw Error(what, "albedo table", "build the sampler again"); };
  const std::size_t columns = a.cos_theta_o.size(), rows = std::max<std::size_t>(a.phi_o.size(), 1);
  std::size_t count = columns * rows;
  if (a.parameters.size() > max_parameters) fail("has more axes than a family has parameters");
  for (const AlbedoAxis& axis : a.parameters) {
    if (!(std::isfinite(axis.lo) && std::isfinite(axis.hi) && axis.lo < axis.hi)) fail("an axis is empty");
    if (axis.rows < 4 || axis.rows > 4096) fail("an axis has not from 4 to 4096 rows");
    count *= axis.rows;
  }
  if (columns < 2 || columns > 60000 || rows > 4096 || a.albedo.size() != count) {
    fail("needs 2 to 60000 nodes, a value each");
  }
  if ((!a.phi_o.empty() && a.phi_o.size() < 3) || (!a.phi_o.empty() && a.phi_o.front() != 0))
    fail("needs three azimuths from 0 on");
  for (std::size_t k = 1; k < a.phi_o.size(); ++k) {
    const float even = a.phi_o.back() * (float(k) / float(a.phi_o.size() - 1));
    if (!(abs(a.phi_o[k] - even) <= 1e-5f * even && even < 6.3f)) fail("the azimuths are not equidistant");
  }
  if (!(a.relative_error >= 0 && a.relative_error <= 1)) fail("the error is not in [0, 1]");
  for (std::size_t i = 0; i < a.albedo.size(); ++i) {
    if (!(std::isfinite(a.albedo[i]) && a.albedo[i] >= 0)) fail("a value is not a number");
  }
  for (std::size_t i = 1; i < columns; ++i) {
    if (!(a.cos_theta_o[i] > a.cos_theta_o[i - 1])) fail("the nodes do not ascend");
  }
  if (a.cos_theta_o.front() != min_cos_theta_o || a.cos_theta_o.back() != 1) {
    fail("the nodes do not span the hemisphere");
  }
}

namespace {

AlbedoPiece piece_of(const std::vector<float>& cosines, const float* albedo, std::size_t i) {
  const double c0 = double(cosines[i]), c1 = double(cosines[i + 1]);
  const double a0 = double(albedo[i]), a1 = double(albedo[i + 1]);
  const double slope = (a1 - a0) / (c1 - c0);
  return {float(a0 - slope * c0), float(slope)};
}

}  // namespace

PackedAlbedo pack(const AlbedoTable& table) {
  const std::size_t columns = table.cos_theta_o.size(), rows = std::max<std::size_t>(table.phi_o.size(), 1);
  PackedAlbedo packed{CosineLookup(table.cos_theta_o), {}, columns - 1, 0};
  if (rows > 1) packed.azimuths_per_radian = float(rows - 1) / table.phi_o.back();
  if (!table.parameters.empty()) {
    packed.parameters = table.parameters;
    const std::vector<float> values = padded(table);
    for (std::size_t first = 0; first < values.size(); first += columns) {
      for (std::size_t i = 0; i + 1 < columns; ++i)
        packed.pieces.push_back(piece_of(table.cos_theta_o, values.data() + first, i));
    }
    return packed;
  }
  const std::ptrdiff_t beyond = rows > 1 ? 1 : 0;
  for (std::ptrdiff_t k = -beyond; k < std::ptrdiff_t(rows) + beyond; ++k) {
    const float* albedo = table.albedo.data() + (rows > 1 ? row_beyond(table, k) : 0) * columns;
    for (std::size_t i = 0; i + 1 < columns; ++i)
      packed.pieces.push_back(piece_of(table.cos_theta_o, albedo, i));
  }
  return packed;
}

}  // namespace reflectree
