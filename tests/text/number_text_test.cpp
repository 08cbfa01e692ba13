// SPDX-License-Identifier: Apache-2.0
#include "reflectree/text/number_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

TEST(NumberText, IsShortestAndReadsBack) {
  EXPECT_EQ(shortest_text(0.1f), "0.1");
  EXPECT_EQ(shortest_text(50), "50");
  EXPECT_EQ(shortest_text(123456), "123456");
  EXPECT_EQ(shortest_text(1e6f), "1e+06");
  EXPECT_EQ(shortest_text(1.f / 3), "0.33333334");
  Pcg32 bits(3);
  for (int i = 0; i < 20'000; ++i) {
    const float x = float(std::pow(10.0, -44 + 82 * to_unit_double(bits())));
    std::string_view text;
    const std::string stored = shortest_text(x);
    text = stored;
    EXPECT_EQ(take_number(text), x);
    EXPECT_TRUE(text.empty());
  }
}

TEST(NumberText, TakesWhatIsANumberAndNoMore) {
  std::string_view text = "1e+x";
  EXPECT_EQ(take_number(text), 1.f);
  EXPECT_EQ(text, "e+x");
  for (std::string_view none : {"", ".", "+", "-.", "e5", "nan", "inf", "x1"}) {
    std::string_view rest = none;
    EXPECT_EQ(take_number(rest), std::nullopt);
    EXPECT_EQ(rest, none);
  }
  text = "1e999999999999";
  EXPECT_EQ(take_number(text), std::numeric_limits<float>::infinity());
  text = "-1e99";
  EXPECT_EQ(take_number(text), -std::numeric_limits<float>::infinity());
  text = "1e-99999";
  EXPECT_EQ(take_number(text), 0.f);
}

}  // namespace
}  // namespace reflectree
