// SPDX-License-Identifier: Apache-2.0
// The white furnace: what the weights add up to, in all and by regions, beside f cos_theta_i by cubature.
#pragma once

#include "examined.hpp"

namespace reflectree::detail {

// Check "light". True where it holds.
bool check_light(const Functions& f, std::span<const ExaminedView> views, double level, Diagnosis& diagnosis);
// Check "support" and its finding.
void check_support(const Functions& f, std::span<const ExaminedView> views, Diagnosis& diagnosis);
// Figures of quality: relative variance, worst weight, share of lost draws, time.
void measure_quality(const Functions& f, std::span<const ExaminedView> views, Diagnosis& diagnosis);

}  // namespace reflectree::detail
