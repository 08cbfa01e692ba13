// SPDX-License-Identifier: Apache-2.0
// How directions are drawn, whatever their density: they are new each time, spread over an area and not over
// lines or points, and know nothing of each other.
#pragma once

#include "examined.hpp"

namespace reflectree::detail {

// Adds checks "spread" and "independent", and a finding for what fails. True where the directions themselves
// are degenerate, so that no density can fit them.
bool check_structure(const Functions& f, std::span<const ExaminedView> views, double level,
                     Diagnosis& diagnosis);

}  // namespace reflectree::detail
