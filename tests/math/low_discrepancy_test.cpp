// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/low_discrepancy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

using Bits = std::uint32_t (*)(std::uint32_t index, std::uint32_t dimension);
std::uint32_t scrambled_7(std::uint32_t index, std::uint32_t dimension) {
  return scrambled_sobol_bits(index, dimension, 7);
}

// Every elementary interval of area 2^-m holds exactly one of the 2^m points from `first` on.
bool is_net(Bits bits, std::uint32_t first, unsigned m, std::uint32_t dim_x, std::uint32_t dim_y) {
  for (unsigned k = 0; k <= m; ++k) {
    std::vector<int> count(std::size_t{1} << m);
    for (std::uint32_t i = 0; i < (1U << m); ++i) {
      const auto x = std::uint64_t{bits(first + i, dim_x)} >> (32U - k);
      const auto y = std::uint64_t{bits(first + i, dim_y)} >> (32U - (m - k));
      ++count[(x << (m - k)) | y];
    }
    if (!std::all_of(count.begin(), count.end(), [](int c) { return c == 1; })) return false;
  }
  return true;
}

bool is_stratified(Bits bits, std::uint32_t first, unsigned m, std::uint32_t dimension) {
  std::vector<int> count(std::size_t{1} << m);
  for (std::uint32_t i = 0; i < (1U << m); ++i) {
    ++count[std::uint64_t{bits(first + i, dimension)} >> (32U - m)];
  }
  return std::all_of(count.begin(), count.end(), [](int c) { return c == 1; });
}

// The example on Joe & Kuo's page (10 points, 3 dimensions) visits the points in Gray-code order.
TEST(Sobol, StartsAsPublished) {
  constexpr double expected[10][3] = {{0, 0, 0},
                                      {.5, .5, .5},
                                      {.75, .25, .25},
                                      {.25, .75, .75},
                                      {.375, .375, .625},
                                      {.875, .875, .125},
                                      {.625, .125, .875},
                                      {.125, .625, .375},
                                      {.1875, .3125, .9375},
                                      {.6875, .8125, .4375}};
  for (std::uint32_t i = 0; i < 10; ++i) {
    for (std::uint32_t d = 0; d < 3; ++d) {
      EXPECT_EQ(to_unit_double(sobol_bits(i ^ (i >> 1U), d)), expected[i][d]) << i << ' ' << d;
    }
  }
}

TEST(Sobol, FirstTwoDimensionsAreANet) {
  for (unsigned m = 0; m <= 12; ++m) EXPECT_TRUE(is_net(sobol_bits, 0, m, 0, 1)) << m;
  EXPECT_TRUE(is_net(sobol_bits, 3U << 8U, 8, 0, 1));
}

TEST(ScrambledSobol, KeepsTheNetInEveryBlock) {
  for (unsigned m = 0; m <= 12; ++m) {
    EXPECT_TRUE(is_net(scrambled_7, 0, m, 0, 1)) << m;
    EXPECT_TRUE(is_net(scrambled_7, 5U << m, m, 4, 5)) << m;
    EXPECT_TRUE(is_net(scrambled_7, 9U << m, m, 40, 41)) << m;
  }
}

TEST(ScrambledSobol, IsStratifiedInEveryDimension) {
  for (std::uint32_t d = 0; d < 12; ++d) EXPECT_TRUE(is_stratified(scrambled_7, 11U << 10U, 10, d)) << d;
}

// The planted twin of the net tests: independent random numbers are no net.
TEST(ScrambledSobol, RandomNumbersAreNoNet) {
  const Bits random = [](std::uint32_t index, std::uint32_t dimension) {
    Pcg32 u(index, dimension);
    return u();
  };
  EXPECT_FALSE(is_net(random, 0, 8, 0, 1));
  EXPECT_FALSE(is_stratified(random, 0, 8, 0));
}

// The quality of other pairs of one block, by the worst box count of a 2^k x 2^k grid: t stays small.
TEST(ScrambledSobol, OtherPairsAreEvenToo) {
  for (std::uint32_t a = 0; a < 4; ++a) {
    for (std::uint32_t b = a + 1; b < 4; ++b) {
      std::vector<int> count(256);
      for (std::uint32_t i = 0; i < 4096; ++i) {
        ++count[((scrambled_7(i, a) >> 28U) << 4U) | (scrambled_7(i, b) >> 28U)];
      }
      EXPECT_EQ(*std::max_element(count.begin(), count.end()), 16) << a << ' ' << b;
    }
  }
}

TEST(ScrambledSobol, AccessIsRandom) {
  std::vector<std::uint32_t> forward;
  for (std::uint32_t i = 0; i < 1000; ++i) forward.push_back(scrambled_sobol_bits(i, i % 9, 3));
  for (std::uint32_t i = 1000; i-- > 0;) EXPECT_EQ(scrambled_sobol_bits(i, i % 9, 3), forward[i]);
  EXPECT_EQ(scrambled_sobol(17, 2, 3), double(scrambled_sobol_bits(17, 2, 3)) * 0x1p-32);
}

TEST(OwenScramble, IsANestedPermutation) {
  for (const std::uint32_t seed : {0U, 1U, 0xdeadbeefU}) {
    for (unsigned m = 1; m <= 10; ++m) {
      for (std::uint32_t i = 0; i < (1U << m); ++i) {
        // The first and the last number of a dyadic interval stay in one interval, in different halves.
        const std::uint32_t lo = i << (32U - m), hi = lo | ((1U << (32U - m)) - 1U);
        const std::uint32_t a = owen_scramble(lo, seed), b = owen_scramble(hi, seed);
        ASSERT_EQ(a >> (32U - m), b >> (32U - m));
        ASSERT_NE(a >> (31U - m), b >> (31U - m));
      }
    }
  }
}

// Over seeds each point is uniform, and a bit's flip depends on the bits above it.
TEST(OwenScramble, IsUniformOverSeedsAndNotADigitalShift) {
  constexpr int seeds = 1 << 14;
  std::vector<int> count(16);
  int same_flip = 0;
  for (int s = 0; s < seeds; ++s) {
    const auto a = scrambled_sobol_bits(5, 1, std::uint32_t(s));
    ++count[a >> 28U];
    // Indices 0 and 1 lie in different halves in dimension 0 and agree in the unscrambled second bit.
    const auto p = scrambled_sobol_bits(0, 0, std::uint32_t(s)),
               q = scrambled_sobol_bits(1, 0, std::uint32_t(s));
    same_flip += ((p >> 30U) & 1U) == ((q >> 30U) & 1U);
  }
  double chi_square = 0;
  for (const int c : count) chi_square += (c - seeds / 16.) * (c - seeds / 16.) / (seeds / 16.);
  EXPECT_LT(chi_square, 44.3);  // 15 degrees of freedom, p = 1e-4
  EXPECT_NEAR(same_flip, seeds / 2, 4 * std::sqrt(seeds) / 2);
}

// For smooth integrands the variance over seeds falls nearly as n^-3, against n^-1 of random points.
TEST(ScrambledSobol, VarianceFallsFasterThanRandom) {
  const auto variance = [](std::uint32_t n, std::uint32_t dim) {
    double sum = 0, sum2 = 0;
    constexpr int seeds = 200;
    for (std::uint32_t s = 0; s < seeds; ++s) {
      double mean = 0;
      for (std::uint32_t i = 0; i < n; ++i) {
        mean += std::exp(scrambled_sobol(i, dim, s) * scrambled_sobol(i, dim + 1, s)) / n;
      }
      sum += mean / seeds;
      sum2 += mean * mean / seeds;
    }
    const double exact = 1.3179021514544038;  // sum over k of 1 / (k! (k + 1)^2)
    EXPECT_NEAR(sum, exact, 5 * std::sqrt((sum2 - sum * sum) / seeds) + 1e-12);
    return sum2 - sum * sum;
  };
  for (const std::uint32_t dim : {0U, 2U, 4U}) {
    const double v16 = variance(16, dim), v256 = variance(256, dim);
    EXPECT_LT(v256, v16 / 256) << dim;  // at least n^-2
  }
}

}  // namespace
}  // namespace reflectree
