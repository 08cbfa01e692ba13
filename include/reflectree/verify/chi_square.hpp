// SPDX-License-Identifier: Apache-2.0
// Goodness of fit of a sampler's directions: Pearson's chi-square over bins of equal probability. Unlike
// the uniform bins of most renderers these see a lobe of any sharpness, and every bin has the same power.
// Bends inside a bin stay invisible: the twins in tests/verify show what is seen.
#pragma once

#include <cstdint>

#include "reflectree/verify/bins.hpp"
#include "reflectree/verify/result.hpp"

namespace reflectree {

struct ChiSquareOptions {
  std::uint64_t samples = 1'000'000;
  std::uint64_t seed = 1;
  double family_significance = 1e-4;
  int tests = 1;  // in the family: each is done at Sidak's level
};

// Directions drawn for bins.wo, sorted into the bins. Independent of the number of threads.
struct Tally {
  std::string sampler;
  std::vector<std::uint64_t> count;     // per bin
  std::vector<double> weight, weight2;  // sum of the weights, and of their squares
  std::uint64_t samples = 0;
  std::uint64_t none = 0;     // "no sample"
  std::uint64_t dead = 0;     // weight 0
  std::uint64_t invalid = 0;  // below the horizon, not finite, or not of unit length
};
Tally tally_of(const ErasedSampler& sampler, const Bins& bins, const ChiSquareOptions& options = {},
               const Host& host = {});

// 1. Exact mode: the counts are as t cos_i. Any invalid direction fails.
CheckResult check_counts(const Tally& tally, const Bins& bins, const ChiSquareOptions& options = {});
// 2. One-shot mode: the counts are as the sampler's own pdf, `density` its masses in the bins.
CheckResult check_counts(const Tally& tally, std::span<const double> density,
                         const ChiSquareOptions& options = {});
// 3. Any mode: the weighted counts are t cos_i itself, bin by bin, by measured variances.
CheckResult check_weights(const Tally& tally, const Bins& bins, const ChiSquareOptions& options = {});
// 4. Any mode: the mean weight is the albedo, within the significance and `tolerance` relative.
CheckResult check_mean_weight(const Tally& tally, const Bins& bins, const ChiSquareOptions& options = {},
                              double tolerance = 1e-4);

// p-values of independent tests, each too weak alone: the sum of their normal quantiles (Stouffer 1949).
CheckResult check_together(const std::string& name, std::span<const double> p_values,
                           const ChiSquareOptions& options = {});

// Variance of the weight over its mean squared; "no sample" counts as weight 0.
double relative_variance(const Tally& tally);

}  // namespace reflectree
