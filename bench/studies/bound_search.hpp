// SPDX-License-Identifier: Apache-2.0
// Looks for values above the bounds of a sampler, leaf by leaf, from many starts.
#pragma once

#include <cstdint>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/family.hpp"
#include "reflectree/host.hpp"
#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree::study {

struct BoundSearch {
  std::uint64_t evaluations = 1000000000;
  std::uint64_t seed = 1;
};
struct BoundFindings {
  double worst = 0;          // the largest T / (albedo M q)
  double theta_o = 0;        // there, radians
  std::uint32_t leaf = 0;    // and the leaf, as packed
  std::uint64_t above = 0;   // evaluations above 1
  std::uint64_t leaves = 0;  // in which there are such
};

// Half of the starts lie anywhere; the others in logarithmic distances from the borders of leaves (rim, pole and the
// plane of incidence among them), from the ends of slabs, and from grazing. The best of sixteen climbs by steps
// of all sizes. Every leaf gets the same share. The result does not depend on the threads.
// packed: that of `data`, perhaps with other heights of leaves. Viewers are any of those that fold to a slab.
BoundFindings search_bounds(const SamplerData& data, const PackedSampler& packed, const AnyBrdf& f,
                            const BoundSearch& options, const Host& host);
BoundFindings search_bounds(const SamplerData& data, const PackedSampler& packed, const AnyFamily& f,
                            const BoundSearch& options, const Host& host);

}  // namespace reflectree::study
