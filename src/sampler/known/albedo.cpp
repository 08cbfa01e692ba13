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

bool is_outside(const std::vector<float>& x, float c) { return x.empty() || !(c >= x.front()) || c > x.back(); }

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
  const float* here = table.albedo.data() + k * x.size() + i;
  const float* next = here + x.size();
  return linear_mix(at - float(k), linear_mix(t, here[0], here[1]), linear_mix(t, next[0], next[1]));
}

void validate(const AlbedoTable& a) {
  const auto fail = [](const char* what) { throw Error(what, "albedo table", "build the sampler again"); };
  const std::size_t columns = a.cos_theta_o.size(), rows = std::max<std::size_t>(a.phi_o.size(), 1);
  if (columns < 2 || columns > 60000 || rows > 4096 || a.albedo.size() != columns * rows) {
    fail("needs 2 to 60000 nodes, a value each");
  }
  if (a.phi_o.size() == 1 || (!a.phi_o.empty() && a.phi_o.front() != 0)) fail("the azimuths do not begin at 0");
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
  for (std::size_t k = 0; k < rows; ++k) {
    const float* albedo = table.albedo.data() + k * columns;
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
