// SPDX-License-Identifier: Apache-2.0
// Integrals over many boxes of a chart, each by a cubature of its own.
#pragma once

#include <vector>

#include "reflectree/host.hpp"
#include "reflectree/math/cubature.hpp"

namespace reflectree::detail {

// The cells from which every cubature here starts, over the whole chart. A bin in a dim place is large: from
// two cells by two it may miss what fills a corner of it, with a small error estimate.
inline constexpr int grid_x = 96, grid_y = 48;

struct BoxRule : CubatureOptions {
  // A sampler's density may reach over the border of a patch by a sliver of one of its leaves.
  bool slivers = false;
};

// concurrent: whether f may be called from several threads.
std::vector<CubatureResult> integrate_all(const Integrand& f, bool concurrent,
                                          const std::vector<CubatureBox>& boxes, const BoxRule& rule,
                                          const Host& host);

}  // namespace reflectree::detail
