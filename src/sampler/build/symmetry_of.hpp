// SPDX-License-Identifier: Apache-2.0
// Which turns and mirror images leave a function alone.
#pragma once

#include "examined_pairs.hpp"

namespace reflectree::detail {

// Whether f changes when both directions turn about the normal.
bool is_anisotropic(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                    const std::vector<Direction>& wi, std::uint64_t seed);

// The largest symmetry that every pair confirms, with its axis; lobe_axis: the azimuth along which
// lobes reach farthest.
ViewerFrame frame_of(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                     const std::vector<Direction>& wi, float lobe_axis, std::uint64_t seed);

}  // namespace reflectree::detail
