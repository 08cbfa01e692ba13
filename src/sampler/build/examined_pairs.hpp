// SPDX-License-Identifier: Apache-2.0
// The pairs of directions at which a function is examined, and its values there.
#pragma once

#include <vector>

#include "field.hpp"

namespace reflectree::detail {

// Pairs in the plane of incidence of wo, spread by the maps of two domains so that lobes are met.
void make_pairs(std::uint64_t seed, std::vector<Direction>& wo, std::vector<Direction>& wi);
// Beside the lobes that f tells of, and the ridges.
void add_lobe_pairs(const AnyBrdf& f, const std::vector<Ridge>& ridges, std::vector<Direction>& wo,
                    std::vector<Direction>& wi);
// Pairs whose viewers lie at azimuth 0, turned about the normal.
void turn_at_random(std::uint64_t seed, std::vector<Direction>& wo, std::vector<Direction>& wi);

using Values = std::vector<float>;
Values values_at(const AnyBrdf& f, const std::vector<Direction>& wo, const std::vector<Direction>& wi);
void refuse_bad_values(const AnyBrdf& f, const Values& values, const std::vector<Direction>& wo,
                       const std::vector<Direction>& wi);
// Sum of |a - b| over half the sum of both.
float difference(const Values& a, const Values& b);

}  // namespace reflectree::detail
