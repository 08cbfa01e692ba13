// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/albedo.hpp"

#include <algorithm>
#include <cmath>

#include "albedo_axes.hpp"
#include "reflectree/error.hpp"
#include "reflectree/math/scalar.hpp"

namespace reflectree {

detail::Beyond detail::row_at(const AlbedoTable& table, const AlbedoSegment& segment, std::ptrdiff_t k) {
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

namespace {

using namespace detail;

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

namespace {

// Along the line after node i.
float on_line(const AlbedoTable& table, std::size_t i, float c) {
  const auto& x = table.cos_theta_o;
  const float t = (c - x[i]) / (x[i + 1] - x[i]);
  return linear_mix(t, table.albedo[i], table.albedo[i + 1]);
}

}  // namespace

float albedo_at(const AlbedoTable& table, float c) {
  const auto& x = table.cos_theta_o;
  return is_outside(x, c) ? 0 : on_line(table, node_before(x, c), c);
}

CosineLookup guide_to(const AlbedoTable& table) {
  std::vector<float> borders = table.cos_theta_o;
  borders.push_back(2);
  return CosineLookup(std::move(borders));
}

float albedo_at(const AlbedoTable& table, const CosineLookup& guide, float c) {
  const auto& x = table.cos_theta_o;
  return is_outside(x, c) ? 0 : on_line(table, std::min(guide(c), x.size() - 2), c);
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
  for (const float error : {a.relative_error, a.proved_error}) {
    if (!(error >= 0 && error <= 1)) fail("the error is not in [0, 1]");
  }
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

}  // namespace reflectree
