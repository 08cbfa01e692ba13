// SPDX-License-Identifier: Apache-2.0
// Counts what this thread allocates, in a program that links allocations.cpp.
#pragma once

#include <cstddef>

namespace reflectree {

std::size_t allocations();

}  // namespace reflectree
