// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/circle.hpp"

#include <gtest/gtest.h>

namespace reflectree {
namespace {

TEST(Circle, points_are_those_of_the_library) {
  double worst = 0;
  for (int i = 0; i <= 1 << 24; i += 5) {
    const float turns = float(i) * 0x1p-24f;
    const auto [x, y] = on_circle(turns);
    const double phi = 2 * pi_v<double> * double(turns);
    worst = std::max({worst, std::abs(double(x) - std::cos(phi)), std::abs(double(y) - std::sin(phi))});
  }
  EXPECT_LT(worst, 1.2e-7);
}

TEST(Circle, quarters_are_exact) {
  EXPECT_EQ(on_circle(0), (Vec2<float>{1, 0}));
  EXPECT_EQ(on_circle(.25f), (Vec2<float>{0, 1}));
  EXPECT_EQ(on_circle(.5f), (Vec2<float>{-1, 0}));
  EXPECT_EQ(on_circle(.75f), (Vec2<float>{0, -1}));
  EXPECT_EQ(on_circle(1), (Vec2<float>{1, 0}));
}

}  // namespace
}  // namespace reflectree
