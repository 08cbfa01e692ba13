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

void validate(const AlbedoTable& a) {
  const auto fail = [](const char* what) { throw Error(what, "albedo table", "build the sampler again"); };
  const std::size_t columns = a.cos_theta_o.size(), rows = std::max<std::size_t>(a.phi_o.size(), 1);
  if (columns < 2 || columns > 60000 || rows > 4096 || a.albedo.size() != columns * rows) {
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

PackedAlbedo pack(const AlbedoTable& table) {
  const std::size_t columns = table.cos_theta_o.size(), rows = std::max<std::size_t>(table.phi_o.size(), 1);
  PackedAlbedo packed{CosineLookup(table.cos_theta_o), {}, columns - 1, 0};
  if (rows > 1) packed.azimuths_per_radian = float(rows - 1) / table.phi_o.back();
  const std::ptrdiff_t beyond = rows > 1 ? 1 : 0;
  for (std::ptrdiff_t k = -beyond; k < std::ptrdiff_t(rows) + beyond; ++k) {
    const float* albedo = table.albedo.data() + (rows > 1 ? row_beyond(table, k) : 0) * columns;
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      const double c0 = double(table.cos_theta_o[i]), c1 = double(table.cos_theta_o[i + 1]);
      const double a0 = double(albedo[i]), a1 = double(albedo[i + 1]);
      const double slope = (a1 - a0) / (c1 - c0);
      packed.pieces.push_back({float(a0 - slope * c0), float(slope)});
    }
  }
  return packed;
}

}  // namespace reflectree
