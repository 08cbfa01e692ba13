// SPDX-License-Identifier: Apache-2.0
// The sampler of one member, cut out of that of its family: what is drawn, looked at and compared like any
// other, and as quick.
#pragma once

#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree {

// The slabs that hold the parameters, the albedo there, the domain with the member's widths. `material` and
// `probes` (identity.hpp) are the member's. Throws Error where data is of no family, or outside of the ranges.
SamplerData member_data(const SamplerData& family, const Parameters& at, std::string material,
                        const BrdfProbes& probes);

}  // namespace reflectree
