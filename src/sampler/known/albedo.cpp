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
  AlbedoSegment segment{};
  for (const AlbedoSegment& s : segments_of(table)) {
    if (s.first == 0 || table.phi_o[s.first] <= phi_o) segment = s;
  }
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

void validate(const AlbedoTable& a) {
  const auto fail = [](const char* what) { throw Error(what, "albedo table", "build the sampler again"); };
  const std::size_t columns = a.cos_theta_o.size(), rows = std::max<std::size_t>(a.phi_o.size(), 1);
  if (columns < 2 || columns > 60000 || rows > 4096 || a.albedo.size() != columns * rows) {
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

}  // namespace

PackedAlbedo pack(const AlbedoTable& table) {
  const std::size_t columns = table.cos_theta_o.size();
  PackedAlbedo packed{CosineLookup(table.cos_theta_o), {}, columns - 1, {}};
  if (table.phi_o.empty()) {
    pack_row(table.cos_theta_o, table.albedo.data(), packed.pieces);
    return packed;
  }
  for (const AlbedoSegment& segment : segments_of(table)) {
    const float begin = table.phi_o[segment.first], end = table.phi_o[segment.first + segment.rows - 1];
    packed.segments.push_back({begin, float(segment.rows - 1) / (end - begin),
                               std::uint32_t(packed.pieces.size() / packed.row),
                               std::uint32_t(segment.rows - 2)});
    std::vector<float> row(columns);
    for (std::ptrdiff_t k = -1; k <= std::ptrdiff_t(segment.rows); ++k) {
      const Beyond b = row_at(table, segment, k);
      for (std::size_t i = 0; i < columns; ++i) {
        row[i] = 0;
        for (std::size_t m = 0; m < 4; ++m) row[i] += b.weight[m] * table.albedo[b.row[m] * columns + i];
      }
      pack_row(table.cos_theta_o, row.data(), packed.pieces);
    }
  }
  return packed;
}

}  // namespace reflectree
