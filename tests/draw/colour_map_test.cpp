// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/colour_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace reflectree::draw {
namespace {

TEST(ColourMap, EndsAndMiddle) {
  EXPECT_EQ(colour(0), (Rgb8{0x09, 0x12, 0x2a}));
  EXPECT_EQ(colour(0.5), (Rgb8{0xb3, 0x4b, 0x98}));
  EXPECT_EQ(colour(1), (Rgb8{0xfb, 0xf4, 0xc5}));
  EXPECT_EQ(colour(-3), colour(0));
  EXPECT_EQ(colour(7), colour(1));
  EXPECT_EQ(colour(std::nan("")), colour(0));
  EXPECT_EQ(palette().front(), colour(0));
  EXPECT_EQ(palette().back(), colour(1));
}

TEST(ColourMap, OklabLightnessOfKnownColours) {
  EXPECT_NEAR(oklab_lightness({255, 255, 255}), 1, 1e-4);
  EXPECT_NEAR(oklab_lightness({0, 0, 0}), 0, 1e-9);
  EXPECT_NEAR(oklab_lightness({255, 0, 0}), 0.62796, 1e-4);  // Ottosson 2020
}

// What makes equal steps look equal, and grey prints and colour-blind eyes see the same order.
double worst_bend(Rgb8 (*map)(double), double from, double to) {
  const double first = oklab_lightness(map(from)), last = oklab_lightness(map(to));
  double worst = 0;
  for (int i = 0; i <= 200; ++i) {
    const double u = i / 200.0;
    worst = std::max(worst,
                     std::abs(oklab_lightness(map(from + u * (to - from))) - (first + u * (last - first))));
  }
  return worst;
}

TEST(ColourMap, LightnessRisesLinearly) { EXPECT_LT(worst_bend(colour, 0, 1), 0.012); }

TEST(ColourMap, ARainbowIsRejected) {
  const auto rainbow = [](double t) {
    const auto wave = [t](double shift) {
      return std::uint8_t(127.5 * (1 + std::cos(6.2832 * (t - shift))));
    };
    return Rgb8{wave(1), wave(0.67), wave(0.33)};
  };
  EXPECT_GT(worst_bend(rainbow, 0, 1), 0.05);
}

TEST(ColourMap, DivergingIsSymmetricInLightness) {
  for (int i = 0; i <= 50; ++i) {
    const double u = i / 100.0;
    EXPECT_NEAR(oklab_lightness(diverging_colour(u)), oklab_lightness(diverging_colour(1 - u)), 0.012);
  }
  EXPECT_LT(worst_bend(diverging_colour, 0, 0.5), 0.02);
}

}  // namespace
}  // namespace reflectree::draw
