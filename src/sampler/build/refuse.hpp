// SPDX-License-Identifier: Apache-2.0
// The sentences by which a build refuses what a function returned.
#pragma once

#include <span>
#include <string>

#include "reflectree/brdf/brdf.hpp"

namespace reflectree::detail {

// "wo = (x, y, z), wi = (x, y, z)"
std::string describe(Direction wo, Direction wi);

inline bool is_good(float v) { return v >= 0 && v <= 3.4028235e38f; }

// Throws Error for values of f of which one is negative, NaN or infinite.
[[noreturn]] void refuse_values(std::span<const float> values, const std::string& name, Direction wo,
                                Direction wi);

}  // namespace reflectree::detail
