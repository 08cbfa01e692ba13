// SPDX-License-Identifier: Apache-2.0
// Builds a sampler's canonical data from any BRDF that can be evaluated. Nothing to tune.
#pragma once

#include <optional>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/sampler/host.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree {

struct BuildOptions {
  Target target;
  float expected_trials = 1.25f;    // of exact mode, for every wo
  float one_shot_variance = 0.01f;  // relative variance of the target's weight, one-shot mode
  float albedo_error = 1e-4f;       // relative
  std::optional<Domain> domain;     // default: the cheapest, found by trial
  std::uint64_t seed = 1;
};

// Throws Error for a function that is negative, NaN, infinite, or differs between two calls;
// Cancelled when the host says so. The result does not depend on the host's threads.
SamplerData build(const AnyBrdf& f, const BuildOptions& options = {}, const Host& host = {});

}  // namespace reflectree
