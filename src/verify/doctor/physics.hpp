// SPDX-License-Identifier: Apache-2.0
// Reciprocity and energy of eval: what tells f from f cos_theta_i, and what is remarked on.
#pragma once

#include "examined.hpp"

namespace reflectree::detail {

struct Pairs {
  Directions wo, wi;
};
// Pairs at moderate elevations, half of them near mirror pairs.
Pairs random_pairs(std::size_t count, std::uint64_t seed);

// How far eval is from reciprocal, as f and as f cos_theta_i.
struct Reciprocity {
  double f = 0, f_cos = 0;
};
Reciprocity reciprocity_of(const Functions& raw, std::uint64_t seed, std::size_t count);

void remark_on_physics(const Functions& f, std::span<const ExaminedView> views, std::uint64_t seed,
                       Diagnosis& diagnosis);

}  // namespace reflectree::detail
