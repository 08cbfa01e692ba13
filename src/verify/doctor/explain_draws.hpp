// SPDX-License-Identifier: Apache-2.0
// Which mistake explains a pdf or a weight that is wrong draw by draw.
#pragma once

#include "around_draws.hpp"

namespace reflectree::detail {

inline constexpr double explains = 0.98;  // share of draws that a hypothesis must agree with

// Cause and words of a finding about the pdf that sample returns.
void explain_pdf(const AroundDraws& around, std::span<const ExaminedView> views, Finding& finding);
// The same about the weight, f cos_theta_i / density; false: nothing explains it.
bool explain_weight(const AroundDraws& around, const Values& claimed, const Values& density,
                    Finding& finding);

}  // namespace reflectree::detail
