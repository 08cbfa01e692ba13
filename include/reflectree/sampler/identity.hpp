// SPDX-License-Identifier: Apache-2.0
// A sampler belongs to one BRDF, known by its target at 64 fixed pairs of directions, compared with a
// tolerance: a hash of floats would differ between compilers.
#pragma once

#include "reflectree/brdf/family.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree {

BrdfProbes probe_identity(const AnyBrdf& f, const Target& target);
// Of members all over the ranges, one per pair.
BrdfProbes probe_identity(const AnyFamily& family, const Target& target);
// Throws Error, naming the pair that differs most, if f is not the BRDF that the sampler was built for.
void check_identity(const SamplerData& data, const AnyBrdf& f, float relative_tolerance = 1e-3f);
// The same for a family, whose ranges must be those of the sampler.
void check_identity(const SamplerData& data, const AnyFamily& family, float relative_tolerance = 1e-3f);

}  // namespace reflectree
