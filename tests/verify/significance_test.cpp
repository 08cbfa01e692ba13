// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/significance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "reflectree/math/random.hpp"
#include "reflectree/verify/result.hpp"

namespace reflectree {
namespace {

TEST(Significance, TailsAreThoseOfTheTables) {
  EXPECT_NEAR(chi_square_tail(18.307, 10), 0.05, 1e-5);
  EXPECT_NEAR(chi_square_tail(2 * std::log(100.), 2), 0.01, 1e-12);  // exp(-x / 2)
  EXPECT_EQ(chi_square_tail(0, 5), 1);
  EXPECT_NEAR(chi_square_tail(chi_square_quantile(1e-6, 399), 399), 1e-6, 1e-12);
  EXPECT_NEAR(normal_two_sided(1.959964), 0.05, 1e-6);
  EXPECT_NEAR(normal_two_sided(normal_two_sided_quantile(1e-5)), 1e-5, 1e-12);
}

TEST(Significance, SidakKeepsTheFamily) {
  EXPECT_DOUBLE_EQ(sidak(1e-4, 1), 1e-4);
  for (const int n : {2, 100, 100000}) EXPECT_NEAR(1 - std::pow(1 - sidak(1e-4, n), n), 1e-4, 1e-10);
}

TEST(Significance, RateBoundCoversTheRate) {
  EXPECT_NEAR(rate_upper_bound(0, 1000, 0.95), 1 - std::pow(0.05, 1e-3), 1e-12);
  EXPECT_EQ(rate_upper_bound(7, 7, 0.95), 1);
  // P(X <= k) = 1 - confidence at the bound; here k = 1 of 10.
  const double p = rate_upper_bound(1, 10, 0.9);
  EXPECT_NEAR(std::pow(1 - p, 10) + 10 * p * std::pow(1 - p, 9), 0.1, 1e-10);
  // From below: P(X >= 1) = 1 - confidence.
  EXPECT_NEAR(1 - std::pow(1 - rate_lower_bound(1, 10, 0.9), 10), 0.1, 1e-10);
  EXPECT_EQ(rate_lower_bound(0, 10, 0.9), 0);
}

TEST(Significance, MeanBoundCoversTheMeanOfRareEvents) {
  Pcg32 u(1);
  int missed = 0;
  for (int run = 0; run < 400; ++run) {
    double sum = 0, sum2 = 0;
    constexpr int n = 2000;
    for (int i = 0; i < n; ++i) {
      const double x = to_unit_double(u()) < 0.002 ? to_unit_double(u()) : 0;  // mean 0.001
      sum += x, sum2 += x * x;
    }
    const double mean = sum / n;
    missed += mean_upper_bound(mean, (sum2 - n * mean * mean) / (n - 1), 1, n, 0.95) < 0.001;
  }
  EXPECT_LE(missed, 20);
}

TEST(CheckResult, ReadsInOneLine) {
  const CheckResult good{"chi_square", true, 412.3, 520.1, 0.34, "cosine"};
  EXPECT_EQ(to_line(good), "pass  chi_square              412.3 <= 520.1       p = 0.34  (cosine)");
  CheckResult bad = good;
  bad.passed = false;
  bad.statistic = 600;
  EXPECT_EQ(to_line(bad).substr(0, 6), "FAIL  ");
  EXPECT_NE(to_line(bad).find("600 >  520.1"), std::string::npos);
  const CheckResult both[] = {good, bad};
  EXPECT_FALSE(all_passed(both));
  EXPECT_TRUE(all_passed({both, 1}));
}

}  // namespace
}  // namespace reflectree
