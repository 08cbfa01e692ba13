// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "field.hpp"

namespace reflectree::detail {

// Elevations of wo, in radians and ascending, at which f changes by leaps for many wi at once: a border
// between slabs and between panels of the albedo belongs there, for nothing that is continuous in theta_o
// serves both sides. Edges that move with theta_o are none. Found by bisection, to 1e-7.
std::vector<float> find_theta_jumps(const Field& field, const Host& host, Effort& effort);

}  // namespace reflectree::detail
