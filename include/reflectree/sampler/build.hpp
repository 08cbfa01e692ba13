// SPDX-License-Identifier: Apache-2.0
// Builds a sampler's canonical data from any BRDF that can be evaluated. Nothing to tune.
#pragma once

#include <optional>

#include "reflectree/brdf/family.hpp"
#include "reflectree/host.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree {

struct BuildOptions {
  Target target;
  float expected_trials = 1.25f;    // of exact mode, for every wo
  float one_shot_variance = 0.01f;  // relative, of one-shot weights; anisotropic: 4 x beyond 80 deg
  float albedo_error = 1e-4f;       // relative
  std::optional<Domain> domain;     // default: the cheapest, found by trial
  std::uint64_t seed = 1;
  // Of f. A build that would need more ends with what it has, and report.notes says what is missing.
  std::uint64_t max_evaluations = 240'000'000;
};

// Throws Error for a function that is negative, NaN, infinite, differs between two calls, changes when both
// directions turn about the normal, or hides lobes that even a second look does not resolve; and for options
// out of range. Cancelled when the host says so. What is promised and not kept is in report.notes, in words.
// The result does not depend on the host's threads.
SamplerData build(const AnyBrdf& f, const BuildOptions& options = {}, const Host& host = {});
// One sampler of every member of a family, by the same promises for each.
SamplerData build(const AnyFamily& family, const BuildOptions& options = {}, const Host& host = {});

}  // namespace reflectree
