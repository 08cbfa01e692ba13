// SPDX-License-Identifier: Apache-2.0
// The packed form against the canonical one: what samples is what was built, saved and drawn.
#pragma once

#include <vector>

#include "reflectree/sampler/packed_sampler.hpp"
#include "reflectree/verify/result.hpp"

namespace reflectree {

//   packed_albedo    at every node, and at three places between two, linear interpolation
//   packed_slabs     either side of every border finds its own slab
//   packed_leaves    cells, slopes and heights are those of the canonical leaves
//   packed_choice    the probabilities of the alias tables, added up in integers, are the masses; one leaf
//                    of a slab takes up what is missing to a multiple of the count, less than a unit per leaf
//   packed_descent   every lower share is that of the masses below
std::vector<CheckResult> check_packing(const SamplerData& data, const PackedSampler& packed);

}  // namespace reflectree
