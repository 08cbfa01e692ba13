// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/exponential.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace reflectree {
namespace {

TEST(Exponential, is_that_of_the_library) {
  double worst = 0;
  for (int i = 0; i < 3'000'000; ++i) {
    const float x = -87 * float(i) / 3'000'000;
    const double right = std::exp(double(x));
    worst = std::max(worst, std::abs(double(exp_of_negative(x)) - right) / right);
  }
  EXPECT_LT(worst, 1.5e-7);
}

TEST(Exponential, ends) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(exp_of_negative(0), 1);
  EXPECT_EQ(exp_of_negative(-infinity), 0);
  EXPECT_EQ(exp_of_negative(-90), std::exp(-90.f));
  EXPECT_TRUE(std::isnan(exp_of_negative(std::numeric_limits<float>::quiet_NaN())));
}

}  // namespace
}  // namespace reflectree
