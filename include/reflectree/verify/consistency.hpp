// SPDX-License-Identifier: Apache-2.0
// The parts of a sampler agree with each other and with the function.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reflectree/host.hpp"
#include "reflectree/verify/bins.hpp"
#include "reflectree/verify/result.hpp"

namespace reflectree {

struct ConsistencyOptions {
  int samples = 20'000;  // per direction wo
  std::uint64_t seed = 1;
  double tolerance = 1e-4;           // relative; of pdf and weight * pdf
  double max_exceptions = 1e-3;      // share of samples outside the tolerance
  double max_none = 0;               // share of "no sample" and of weight 0
  double integral_tolerance = 2e-3;  // of the integral of pdf
};

// A direction in float has an error of about 6e-8, which sharp lobes and the borders of leaves magnify; a
// value agrees where it lies within the tolerance of the range that the other takes over such neighbours.
//   pdf_agrees       sample().pdf == pdf(wo, wi)
//   weight_agrees    weight * pdf == t cos_i
//   support          pdf > 0 wherever t cos_i > 0 (and cos_i > 5e-4, which float disks can hold)
//   alive            no "no sample", no weight 0, no direction below the horizon
//   finite           every direction, pdf and weight finite
//   pdf_integral     integral of pdf + share of "no sample" = 1
// Those about pdf are left out for a sampler without one; if its samples' pdf is 0 as well, the density is
// unknown, and there is nothing for a weight to agree with.
std::vector<CheckResult> check_consistency(const ErasedSampler& sampler, const TargetFunction& f,
                                           Direction wo, const ConsistencyOptions& options = {},
                                           const Host& host = {});
// The same where the bins of f and density_masses() in them are known.
std::vector<CheckResult> check_consistency(const ErasedSampler& sampler, const TargetFunction& f,
                                           const Bins& bins, std::span<const double> density,
                                           const ConsistencyOptions& options = {});

}  // namespace reflectree
