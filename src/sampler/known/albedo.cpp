// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/albedo.hpp"

#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/math/scalar.hpp"

namespace reflectree {

float albedo_at(const AlbedoTable& table, float c) {
  const auto& x = table.cos_theta_o;
  if (x.empty() || !(c >= x.front()) || c > x.back()) return 0;
  // The last entry up to c, by halving without a branch: random cosines would mispredict it.
  std::size_t i = 0;
  for (std::size_t count = x.size() - 1; count > 1;) {
    const std::size_t half = count / 2;
    i += x[i + half] <= c ? half : 0;
    count -= half;
  }
  const float t = (c - x[i]) / (x[i + 1] - x[i]);
  return linear_mix(t, table.albedo[i], table.albedo[i + 1]);
}

void validate(const AlbedoTable& a) {
  const auto fail = [](const char* what) { throw Error(what, "albedo table", "build the sampler again"); };
  if (a.cos_theta_o.size() < 2 || a.cos_theta_o.size() != a.albedo.size() || a.cos_theta_o.size() > 60000) {
    fail("needs 2 to 60000 nodes, a value each");
  }
  if (!(a.relative_error >= 0 && a.relative_error <= 1)) fail("the error is not in [0, 1]");
  for (std::size_t i = 0; i < a.albedo.size(); ++i) {
    if (!(std::isfinite(a.albedo[i]) && a.albedo[i] >= 0)) fail("a value is not a number");
    if (i > 0 && !(a.cos_theta_o[i] > a.cos_theta_o[i - 1])) fail("the nodes do not ascend");
  }
  if (a.cos_theta_o.front() != min_cos_theta_o || a.cos_theta_o.back() != 1) {
    fail("the nodes do not span the hemisphere");
  }
}

PackedAlbedo pack(const AlbedoTable& table) {
  PackedAlbedo packed{CosineLookup(table.cos_theta_o), {}};
  for (std::size_t i = 0; i + 1 < table.albedo.size(); ++i) {
    const double c0 = double(table.cos_theta_o[i]), c1 = double(table.cos_theta_o[i + 1]);
    const double a0 = double(table.albedo[i]), a1 = double(table.albedo[i + 1]);
    const double slope = (a1 - a0) / (c1 - c0);
    packed.pieces.push_back({float(a0 - slope * c0), float(slope)});
  }
  return packed;
}

}  // namespace reflectree
