// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/sum.hpp"

#include <gtest/gtest.h>

namespace reflectree {
namespace {

TEST(CompensatedSum, KeepsWhatPlainAdditionLoses) {
  CompensatedSum sum;
  double plain = 0;
  for (const double x : {1.0, 1e100, 1.0, -1e100}) sum += x, plain += x;
  EXPECT_EQ(sum.value(), 2);
  EXPECT_NE(plain, 2);
}

TEST(CompensatedSum, OfTenMillionTenths) {
  CompensatedSum sum;
  double plain = 0;
  for (int i = 0; i < 10'000'000; ++i) sum += 0.1, plain += 0.1;
  EXPECT_NEAR(sum.value(), 1e7 * 0.1, 2e-10);
  EXPECT_GT(std::abs(plain - 1e6), 1e-5);
}

TEST(CompensatedSum, SubtractionUndoesAddition) {
  CompensatedSum sum;
  for (int i = 1; i <= 1000; ++i) sum += 1. / i;
  for (int i = 1; i <= 1000; ++i) sum -= 1. / i;
  EXPECT_NEAR(sum.value(), 0, 1e-16);
}

}  // namespace
}  // namespace reflectree
