// SPDX-License-Identifier: Apache-2.0
// Tails and bounds of the distributions that the checks need.
#pragma once

#include <cstdint>

namespace reflectree {

// P(X >= statistic) for a chi-square variable.
double chi_square_tail(double statistic, double degrees_of_freedom);
// The statistic whose tail is `significance`.
double chi_square_quantile(double significance, double degrees_of_freedom);
// P(|Z| >= z) for a standard normal variable.
double normal_two_sided(double z);
// The z with P(|Z| >= z) = significance.
double normal_two_sided_quantile(double significance);
// The z with P(Z >= z) = significance.
double normal_upper_quantile(double significance);

// Sidak 1967: the level of each of `tests` independent tests at which the whole family errs
// with probability `family`.
double sidak(double family, int tests);

// Upper end of the one-sided Clopper-Pearson interval for the rate of `events` in `trials`.
double rate_upper_bound(std::uint64_t events, std::uint64_t trials, double confidence);
// And the lower end.
double rate_lower_bound(std::uint64_t events, std::uint64_t trials, double confidence);

// Upper bound of the mean of `count` independent variables in [0, range] with the given sample mean and
// variance; Maurer & Pontil 2009, theorem 4 (empirical Bernstein).
double mean_upper_bound(double mean, double variance, double range, std::uint64_t count, double confidence);

}  // namespace reflectree
