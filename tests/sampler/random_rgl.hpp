// SPDX-License-Identifier: Apache-2.0
// The fields of isotropic RGL tables that are noise.
#pragma once

#include "../brdf/random_models.hpp"
#include "reflectree/brdf/tables/rgl_table.hpp"

namespace reflectree {

struct RglSizes {
  std::vector<float> theta_o;
  int warp_width, warp_height, colour_width, colour_height;
};
// Colours from `darkest` to 1.
inline RglFields random_rgl_fields(Pcg32& bits, const RglSizes& sizes, double darkest) {
  RglFields f;
  f.theta_o = sizes.theta_o;
  f.warp_width = sizes.warp_width, f.warp_height = sizes.warp_height;
  f.colour_width = sizes.colour_width, f.colour_height = sizes.colour_height;
  const auto fill = [&bits](std::vector<float>& v, std::size_t n, double lo) {
    for (std::size_t i = 0; i < n; ++i) v.push_back(float(lo + (1 - lo) * uniform(bits)));
  };
  const std::size_t viewers = sizes.theta_o.size();
  fill(f.sigma, 12, 0.3), fill(f.ndf, 17, 0.1);
  fill(f.vndf, viewers * std::size_t(f.warp_width * f.warp_height), 0.05);
  fill(f.rgb, viewers * 3 * std::size_t(f.colour_width * f.colour_height), darkest);
  return f;
}

}  // namespace reflectree
