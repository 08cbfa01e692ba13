// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "field.hpp"

namespace reflectree::detail {

// Viewers at which f changes by leaps for many wi at once: a border between slabs, panels and segments of the
// albedo belongs there, for nothing that is continuous serves both sides. Edges that move with wo are none.
// Found by bisection: in theta_o down to neighbouring floats of its cosine.
Jumps find_jumps(const Field& field, const Host& host, Effort& effort);

}  // namespace reflectree::detail
