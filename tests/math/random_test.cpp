// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/random.hpp"

#include <gtest/gtest.h>

namespace reflectree {
namespace {

// The stream printed by the demo of the reference implementation (pcg-random.org, pcg32_random_r).
TEST(Pcg32, GivesThePublishedStream) {
  Pcg32 u(42, 54);
  for (const std::uint32_t expected :
       {0xa15c02b7U, 0x7b47f409U, 0xba1d3330U, 0x83d2f293U, 0xbfa4784bU, 0xcbed606eU}) {
    EXPECT_EQ(u(), expected);
  }
}

TEST(Pcg32, AdvanceEqualsDrawing) {
  for (const std::uint64_t n : {0ULL, 1ULL, 2ULL, 7ULL, 1000ULL, 123457ULL}) {
    Pcg32 a(7, 3), b(7, 3);
    for (std::uint64_t i = 0; i < n; ++i) a();
    b.advance(n);
    EXPECT_EQ(a(), b()) << n;
  }
}

TEST(Pcg32, AdvanceWrapsAroundThePeriod) {
  Pcg32 a(7, 3), b(7, 3);
  a();
  a.advance(~std::uint64_t{0});  // 2^64 - 1 steps: one step back
  EXPECT_EQ(a(), b());
}

TEST(Pcg32, StreamsDiffer) {
  Pcg32 a(7, 0), b(7, 1);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) equal += a() == b();
  EXPECT_EQ(equal, 0);
}

TEST(UnitInterval, NeverReachesOne) {
  EXPECT_EQ(to_unit_float(0), 0.f);
  EXPECT_EQ(to_unit_float(0xffffffffU), 1 - 0x1p-24f);
  EXPECT_LT(to_unit_double(0xffffffffU), 1.0);
}

}  // namespace
}  // namespace reflectree
