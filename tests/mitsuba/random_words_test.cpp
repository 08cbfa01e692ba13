// SPDX-License-Identifier: Apache-2.0
// Words of numbers that differ in a single bit are independent, and so are the words of one sample.
#include "../../bindings/mitsuba/random_words.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>

#include "reflectree/math/random.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree {
namespace {

constexpr int numbers = 3, words = 2, bits = 32;
using Numbers = std::array<std::uint32_t, numbers>;

// As Mitsuba has them: 23 random bits, so that the lowest of small floats are 0.
Numbers drawn(Pcg32& random) {
  Numbers n;
  for (std::uint32_t& x : n)
    x = std::bit_cast<std::uint32_t>(std::bit_cast<float>((random() >> 9U) | 0x3f800000U) - 1.f);
  return n;
}

template <class Words>
std::array<std::uint32_t, words> words_of(const Numbers& n) {
  Words w(n[0], n[1], n[2]);
  return {w(), w()};
}

// Pairs of words, each sorted into 8 by 8 cells by their highest bits.
struct Pairs {
  std::array<double, 64> count{};
  double n = 0;
  void add(std::uint32_t a, std::uint32_t b) { ++count[(a >> 29U) * 8 + (b >> 29U)], ++n; }
  double p_value() const {
    double statistic = 0;
    for (const double c : count) statistic += (c - n / 64) * (c - n / 64) / (n / 64);
    return chi_square_tail(statistic, 63);
  }
};

struct Finding {
  int tests = 0, rejected = 0;
  double least_p = 1;
  void add(double p, double level) { ++tests, rejected += p < level, least_p = std::min(least_p, p); }
};

// Every word of a sample beside every word of the sample whose numbers differ in one bit, for every bit; and
// the words of one sample beside each other.
template <class Words>
Finding judge() {
  constexpr int samples = 1 << 15, families = numbers * bits * words * words + 1;
  const double level = sidak(1e-4, families);
  Pcg32 random(31);
  Finding found;
  Pairs within;
  for (int number = 0; number < numbers; ++number) {
    for (int bit = 0; bit < bits; ++bit) {
      std::array<Pairs, words * words> pairs;
      for (int i = 0; i < samples; ++i) {
        Numbers n = drawn(random);
        const auto a = words_of<Words>(n);
        n[std::size_t(number)] ^= 1U << unsigned(bit);
        const auto b = words_of<Words>(n);
        for (std::size_t k = 0; k < pairs.size(); ++k) pairs[k].add(a[k / words], b[k % words]);
        within.add(a[0], a[1]);
      }
      for (const Pairs& p : pairs) found.add(p.p_value(), level);
    }
  }
  found.add(within.p_value(), level);
  EXPECT_EQ(found.tests, families);
  return found;
}

TEST(RandomWords, OneBitChangesThemAll) {
  const Finding found = judge<WordsOfNumbers>();
  EXPECT_EQ(found.rejected, 0) << "least p " << found.least_p;
}

// State and stream of PCG32 by the numbers as they are: the mixing that Mitsuba's own test found out.
struct Unmixed : Pcg32 {
  Unmixed(std::uint32_t a, std::uint32_t b, std::uint32_t c) : Pcg32(a ^ std::uint64_t(b) << 32U, c) {}
};
TEST(RandomWordsTwin, StateAndStreamWithoutMixing) { EXPECT_GT(judge<Unmixed>().rejected, 10); }

// The third number as a distance on one sequence: words of neighbours are each other's, one place on.
struct Shifted : WordsOfNumbers {
  Shifted(std::uint32_t a, std::uint32_t b, std::uint32_t c) : WordsOfNumbers(0, 0, 0) {
    state = mix(a | std::uint64_t(b) << 32U) + c * 0x9e3779b97f4a7c15U;
  }
};
TEST(RandomWordsTwin, NeighboursOnOneSequence) { EXPECT_GT(judge<Shifted>().rejected, 0); }

// Half of the third number is left out.
struct Halved : WordsOfNumbers {
  Halved(std::uint32_t a, std::uint32_t b, std::uint32_t c) : WordsOfNumbers(a, b, c >> 16U) {}
};
TEST(RandomWordsTwin, HalfOfANumberIsLeftOut) { EXPECT_GE(judge<Halved>().rejected, 16 * 2); }

}  // namespace
}  // namespace reflectree
