// SPDX-License-Identifier: Apache-2.0
// Values by themselves: finite, not negative, the same when asked again.
#pragma once

#include "functions.hpp"

namespace reflectree::detail {

void check_values(const Functions& f, std::uint64_t seed, Diagnosis& diagnosis);
void check_repeatable(const Functions& f, std::uint64_t seed, Diagnosis& diagnosis);

}  // namespace reflectree::detail
