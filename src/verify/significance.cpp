// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/significance.hpp"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

namespace reflectree {

double chi_square_tail(double statistic, double degrees_of_freedom) {
  if (!(statistic > 0)) return 1;
  return boost::math::cdf(
      boost::math::complement(boost::math::chi_squared(degrees_of_freedom), std::fmin(statistic, 1e12)));
}

double chi_square_quantile(double significance, double degrees_of_freedom) {
  return boost::math::quantile(
      boost::math::complement(boost::math::chi_squared(degrees_of_freedom), significance));
}

double normal_two_sided(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

double normal_two_sided_quantile(double significance) {
  return boost::math::quantile(boost::math::complement(boost::math::normal(), significance / 2));
}

double normal_upper_quantile(double significance) {
  return boost::math::quantile(boost::math::complement(boost::math::normal(), significance));
}

// 1 - (1 - family)^(1 / tests), without cancellation.
double sidak(double family, int tests) { return -std::expm1(std::log1p(-family) / tests); }

double rate_upper_bound(std::uint64_t events, std::uint64_t trials, double confidence) {
  if (events >= trials) return 1;
  const boost::math::beta_distribution<> beta(double(events) + 1, double(trials - events));
  return boost::math::quantile(beta, confidence);
}

double rate_lower_bound(std::uint64_t events, std::uint64_t trials, double confidence) {
  if (events == 0) return 0;
  const boost::math::beta_distribution<> beta(double(events), double(trials - std::min(events, trials)) + 1);
  return boost::math::quantile(beta, 1 - confidence);
}

double mean_upper_bound(double mean, double variance, double range, std::uint64_t count, double confidence) {
  const double l = std::log(2 / (1 - confidence)), n = double(count);
  return mean + std::sqrt(2 * variance * l / n) + 7 * range * l / (3 * (n - 1));
}

}  // namespace reflectree
