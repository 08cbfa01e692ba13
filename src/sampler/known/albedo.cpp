// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/albedo.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

// What stands for a row beyond an end: of a single segment the mirrored one, or, of a whole period, the one
// that comes round; of several the polynomial goes on.
struct Beyond {
  std::array<std::size_t, 4> row{};
  std::array<float, 4> weight{};
};
Beyond row_at(const AlbedoTable& table, const AlbedoSegment& segment, std::ptrdiff_t k) {
  const auto last = std::ptrdiff_t(segment.rows) - 1;
  const bool below = k < 0, beyond = below || k > last;
  Beyond b;
  if (!beyond || segment.rows == table.phi_o.size()) {
    if (below) k = table.even ? -k : k + last;
    if (beyond && !below) k = table.even ? 2 * last - k : k - last;
    b.row[0] = segment.first + std::size_t(k), b.weight[0] = 1;
    return b;
  }
  constexpr float weights[3][4] = {{2, -1, 0, 0}, {3, -3, 1, 0}, {4, -6, 4, -1}};
  const auto order = std::size_t(std::min<std::ptrdiff_t>(last, 3));
  for (std::size_t m = 0; m <= order; ++m) {
    b.row[m] = segment.first + (below ? m : std::size_t(last) - m);
    b.weight[m] = weights[order - 1][m];
  }
  return b;
}

bool is_outside(const std::vector<float>& x, float c) {
  return x.empty() || !(c >= x.front()) || c > x.back();
}

// The last segment that begins at or before phi_o, or the first.
AlbedoSegment segment_at(const std::vector<float>& phi, float phi_o) {
  AlbedoSegment segment{0, phi.size()};
  for (std::size_t k = 1; k < phi.size(); ++k) {
    if (phi[k] != phi[k - 1]) continue;
    if (phi[k] > phi_o) {
      segment.rows = k - segment.first;
      break;
    }
    segment = {k, phi.size() - k};
  }
  return segment;
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
  const std::size_t i = node_before(x, c);
  const float t = (c - x[i]) / (x[i + 1] - x[i]);
  const AlbedoSegment segment = segment_at(table.phi_o, phi_o);
  const float begin = table.phi_o[segment.first], end = table.phi_o[segment.first + segment.rows - 1];
  const float at = clamp((phi_o - begin) / (end - begin), 0.f, 1.f) * float(segment.rows - 1);
  const std::size_t k = std::min(std::size_t(at), segment.rows - 2);
  const std::array<float, 4> weights = cubic_weights(at - float(k));
  float sum = 0;
  for (int n = -1; n <= 2; ++n) {
    const Beyond b = row_at(table, segment, std::ptrdiff_t(k) + n);
    for (std::size_t m = 0; m < 4; ++m) {
      const float* row = table.albedo.data() + b.row[m] * x.size() + i;
      if (b.weight[m] != 0) sum += weights[std::size_t(n + 1)] * b.weight[m] * linear_mix(t, row[0], row[1]);
    }
  }
  return max(sum, 0.f);
}

std::vector<AlbedoSegment> segments_of(const AlbedoTable& table) {
  std::vector<AlbedoSegment> segments;
  const std::vector<float>& phi = table.phi_o;
  for (std::size_t k = 0; k < phi.size(); ++k) {
    if (k == 0 || phi[k] == phi[k - 1]) segments.push_back({k, 0});
    ++segments.back().rows;
  }
  return segments;
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
// How many rows that are.
std::size_t padded_rows(const std::vector<float>& azimuths, const std::vector<AlbedoSegment>& segments) {
  return azimuths.size() + 2 * segments.size();
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

// The rows of the azimuth phi_o in a segment whose first row, with the one before it, is `first`.
RowsOfAxis rows_of_azimuth(std::size_t first, std::size_t rows, float x) {
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

// A value of the table of which `row` counts rows with those beyond the ends.
float padded_value(const AlbedoTable& table, const std::vector<AlbedoSegment>& segments, std::size_t row,
                   std::size_t column) {
  const std::size_t columns = table.cos_theta_o.size();
  // From the innermost axis outwards.
  Beyond azimuth;
  azimuth.weight[0] = 1;
  std::size_t stride = 1;
  if (!segments.empty()) {
    const std::size_t rows = padded_rows(table.phi_o, segments);
    auto k = std::ptrdiff_t(row % rows) - 1;
    auto segment = segments.begin();
    for (; k > std::ptrdiff_t(segment->rows); ++segment) k -= std::ptrdiff_t(segment->rows) + 2;
    azimuth = row_at(table, *segment, k);
    stride = table.phi_o.size();
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
  double sum = 0;
  for (std::size_t m = 0; m < 4; ++m) {
    if (azimuth.weight[m] != 0)
      sum += double(azimuth.weight[m]) * value(value, 0, row, azimuth.row[m], stride);
  }
  return float(sum);
}

}  // namespace

float albedo_at(const AlbedoTable& table, float c, float phi_o, const Coordinates& at) {
  if (table.parameters.empty()) return albedo_at(table, c, phi_o);
  const auto& x = table.cos_theta_o;
  if (is_outside(x, c)) return 0;
  const std::size_t i = node_before(x, c);
  const float t = (c - x[i]) / (x[i + 1] - x[i]);
  const std::vector<AlbedoSegment> segments = segments_of(table);
  RowsOfAxis azimuth;
  std::size_t padded_before = 0;
  for (const AlbedoSegment& s : segments) {
    const float begin = table.phi_o[s.first], end = table.phi_o[s.first + s.rows - 1];
    if (s.first == 0 || begin <= phi_o)
      azimuth = rows_of_azimuth(padded_before, s.rows, (phi_o - begin) / (end - begin) * float(s.rows - 1));
    padded_before += s.rows + 2;
  }
  const std::size_t azimuths = segments.empty() ? 1 : padded_before;
  return over_rows(table.parameters, azimuth, azimuths, at, [&](std::size_t row) {
    return linear_mix(t, padded_value(table, segments, row, i), padded_value(table, segments, row, i + 1));
  });
}

float PackedAlbedo::over_rows(const AlbedoPiece* column, float cos_theta_o, float phi_o,
                              const Coordinates& at) const {
  const Place first = place_at(parameters[0], at[0]);
  const bool two = parameters.size() > 1;
  const Place second = two ? place_at(parameters[1], at[1]) : Place{0, {1}};
  std::size_t azimuth = 0;
  std::array<float, 4> azimuths{};
  if (!segments.empty()) {
    const Segment& segment = segment_at(phi_o);
    const float x = max((phi_o - segment.phi_o) * segment.rows_per_radian, 0.f);
    const std::size_t k = std::min(std::size_t(x), std::size_t(segment.last));
    azimuth = segment.first + k;
    azimuths = cubic_weights(x - float(k));
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
  const std::vector<AlbedoSegment> segments = segments_of(a);
  if (!segments.empty() && a.phi_o.front() != 0) fail("the azimuths do not begin at 0");
  for (const AlbedoSegment& s : segments) {
    if (s.rows < (segments.size() > 1 ? 2U : 3U)) fail("a segment of azimuths needs more rows");
    const float begin = a.phi_o[s.first], end = a.phi_o[s.first + s.rows - 1];
    if (!(end > begin && end < 6.3f)) fail("the azimuths do not ascend");
    for (std::size_t k = 1; k < s.rows; ++k) {
      const float even = linear_mix(float(k) / float(s.rows - 1), begin, end);
      if (!(abs(a.phi_o[s.first + k] - even) <= 1e-5f * end)) fail("the azimuths are not equidistant");
    }
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

const PackedAlbedo::Segment& PackedAlbedo::segment_at(float phi_o) const {
  const auto after = std::upper_bound(segments.begin() + 1, segments.end(), phi_o,
                                      [](float phi, const Segment& s) { return phi < s.phi_o; });
  return *(after - 1);
}

namespace {

// The lines between the nodes of a row.
void pack_row(const std::vector<float>& cosines, const float* albedo, std::vector<AlbedoPiece>& pieces) {
  for (std::size_t i = 0; i + 1 < cosines.size(); ++i) {
    const double c0 = double(cosines[i]), c1 = double(cosines[i + 1]);
    const double a0 = double(albedo[i]), a1 = double(albedo[i + 1]);
    // Between neighbouring floats lies nothing; a line through both sides of a jump would lose every digit.
    // The last line holds its upper end, too.
    const bool neighbours = i + 2 < cosines.size() && std::nextafter(cosines[i], 2.f) >= cosines[i + 1];
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

PackedAlbedo pack(const AlbedoTable& table) {
  const std::size_t columns = table.cos_theta_o.size();
  PackedAlbedo packed{CosineLookup(table.cos_theta_o), {}, columns - 1, {}};
  std::size_t rows = 0;
  for (const AlbedoSegment& segment : segments_of(table)) {
    const float begin = table.phi_o[segment.first], end = table.phi_o[segment.first + segment.rows - 1];
    packed.segments.push_back({begin, float(segment.rows - 1) / (end - begin), std::uint32_t(rows),
                               std::uint32_t(segment.rows - 2)});
    rows += segment.rows + 2;
  }
  const std::vector<float> values = padded(table);
  for (std::size_t first = 0; first < values.size(); first += columns)
    pack_row(table.cos_theta_o, values.data() + first, packed.pieces);
  if (table.parameters.empty()) return packed;
  packed.positive = rows == 0 && table.parameters.size() == 1 && is_positive(values, columns);
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
