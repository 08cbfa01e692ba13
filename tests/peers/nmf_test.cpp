// SPDX-License-Identifier: Apache-2.0
// Non-negative factorisation: a matrix of few terms is found again, and one of more terms is not.
#include "reflectree/peers/nmf.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

constexpr int rows = 20, columns = 50;

// A sum of `terms` products of sparse non-negative vectors.
std::vector<float> matrix_of(int terms) {
  Pcg32 bits(3);
  std::vector<float> y(rows * columns, 0.f);
  for (int k = 0; k < terms; ++k) {
    std::vector<float> a, b;
    for (int i = 0; i < rows; ++i) a.push_back(std::max(to_unit_float(bits()) - 0.3f, 0.f));
    for (int i = 0; i < columns; ++i) b.push_back(std::max(to_unit_float(bits()) - 0.3f, 0.f));
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += a[i / columns] * b[i % columns];
  }
  return y;
}

// sum |y - left right| / sum y
double error(const std::vector<float>& y, const NonNegativeFactors& factors) {
  double off = 0, size = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < std::size_t(factors.terms); ++k) {
      sum += double(factors.left[i / columns * std::size_t(factors.terms) + k]) *
             double(factors.right[k * columns + i % columns]);
    }
    off += std::abs(sum - double(y[i])), size += double(y[i]);
  }
  return off / size;
}

TEST(NonNegativeFactors, FindsAsManyTermsAsThereAre) {
  for (const int terms : {2, 3}) {
    const auto y = matrix_of(terms);
    EXPECT_LT(error(y, factor_non_negative(y, rows, columns, terms, 3000)), 2e-3) << terms;
    EXPECT_GT(error(y, factor_non_negative(y, rows, columns, terms - 1, 3000)), 0.05) << terms;
  }
  const auto y = matrix_of(1);
  EXPECT_LT(error(y, factor_non_negative(y, rows, columns, 1)), 1e-5);
}

TEST(NonNegativeFactors, AreNonNegativeAndNormalised) {
  auto y = matrix_of(3);
  std::fill_n(y.begin(), columns, 0.f);  // a row of zeros
  const auto factors = factor_non_negative(y, rows, columns, 3);
  for (const auto* side : {&factors.left, &factors.right}) {
    for (const float v : *side) ASSERT_TRUE(v >= 0 && std::isfinite(v));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < columns; ++i) sum += double(factors.right[k * columns + i]);
    EXPECT_NEAR(sum, 1, 1e-5);
  }
}

TEST(NonNegativeFactors, AreTheSameEveryTime) {
  const auto y = matrix_of(3);
  EXPECT_EQ(factor_non_negative(y, rows, columns, 2).right, factor_non_negative(y, rows, columns, 2).right);
}

}  // namespace
}  // namespace reflectree
