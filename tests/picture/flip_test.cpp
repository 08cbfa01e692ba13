// SPDX-License-Identifier: Apache-2.0
// FLIP where its value is known: plain colours in closed form, nothing for equal pictures, more for nearer
// eyes.
#include "reflectree/picture/flip.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree {
namespace {

template <class Colour>
Image picture(int width, int height, const Colour& colour) {
  Image image = make_image(width, height, {"R", "G", "B"});
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto c = colour(x, y);
      for (std::size_t k = 0; k < 3; ++k) image.values[image.index(x, y) + k] = c[k];
    }
  }
  return image;
}
template <class Colour>
Image picture(int size, const Colour& colour) {
  return picture(size, size, colour);
}
Image plain(float r, float g, float b) {
  return picture(24, [&](int, int) { return std::array{r, g, b}; });
}

// Grey to grey differs by L* alone, and green to blue by all there is: HyAB = 203.5 with the primaries'
// L*a*b* of textbooks, (87.73, -86.18, 83.18) and (32.30, 79.19, -107.86), a and b times L / 100.
double expected(double difference) {
  const double most = std::pow(
      std::abs(87.73 - 32.30) + std::hypot(.8773 * -86.18 - .3230 * 79.19, .8773 * 83.18 - .3230 * -107.86),
      .7);
  const double d = std::pow(difference, .7);
  return d < .4 * most ? .95 / (.4 * most) * d : .95 + .05 * (d - .4 * most) / (.6 * most);
}
double lightness(double y) { return 116 * std::cbrt(y) - 16; }

TEST(Flip, OfPlainColoursIsTheClosedForm) {
  const auto value = [](const Image& a, const Image& b) { return image_mean(flip_difference(a, b)); };
  const Image black = plain(0, 0, 0), white = plain(1, 1, 1), grey = plain(.2f, .2f, .2f),
              other = plain(.25f, .25f, .25f);
  EXPECT_EQ(value(grey, grey), 0);
  EXPECT_NEAR(value(black, white), expected(100), 5e-4);
  EXPECT_NEAR(value(black, white), .967, 1e-3);
  EXPECT_NEAR(value(grey, other), expected(lightness(.25) - lightness(.2)), 5e-4);
  EXPECT_NEAR(value(plain(0, 1, 0), plain(0, 0, 1)), 1, 1e-6);
  EXPECT_GT(std::abs(value(grey, plain(.251f, .251f, .251f)) - value(grey, other)), 1e-3) << "the twin";
}

TEST(Flip, SeesLessFromFarAndEdgesMore) {
  const auto board = [](int x, int y) {
    const float v = (x + y) % 2 == 0 ? .1f : .3f;
    return std::array{v, v, v};
  };
  const Image checks = picture(48, board), mean = picture(48, [](int, int) {
                                             return std::array{.2f, .2f, .2f};
                                           });
  const double near = image_mean(flip_difference(checks, mean, {.pixels_per_degree = 10})),
               far = image_mean(flip_difference(checks, mean, {.pixels_per_degree = 200}));
  EXPECT_GT(near, .1);
  EXPECT_LT(far, near / 3) << "the eye takes the mean";
  // A dot is more than its share of the blurred difference, and only about where it is.
  const Image dot = picture(48, [](int x, int y) {
    return x == 24 && y == 24 ? std::array{1.f, 1.f, 1.f} : std::array{.2f, .2f, .2f};
  });
  const Image map = flip_difference(mean, dot, {.pixels_per_degree = 30});
  EXPECT_GT(map.values[map.index(24, 24)], .3f);
  EXPECT_LT(map.values[map.index(2, 2)], 1e-3f);
  const Image back = flip_difference(dot, mean, {.pixels_per_degree = 30});
  for (std::size_t i = 0; i < map.values.size(); ++i) ASSERT_NEAR(map.values[i], back.values[i], 1e-6f);
}

// Gradients, checks, a shift and a blot, with what the authors' own program says (flip-evaluator 1.7, of
// linear RGB).
TEST(Flip, AgreesWithItsAuthors) {
  const auto scene = [](bool moved) {
    const auto colour = [moved](int x, int y) {
      const double s = x + (moved ? 1 : 0);
      if (moved && x >= 20 && x < 28 && y >= 10 && y < 16)
        return std::array{1.f, float(.3 + .25 * std::cos(.015 * s * y)), 0.f};
      return std::array{float(.5 + .4 * std::sin(.35 * s + .2 * y)), float(.3 + .25 * std::cos(.015 * s * y)),
                        (int(s) / 6 + y / 6) % 2 != 0 ? .6f : .1f};
    };
    return picture(48, 32, colour);
  };
  const Image reference = scene(false), test = scene(true);
  struct Known {
    double ppd, mean, blot, corner, last;
  };
  for (const Known& k :
       {Known{67.0206, .311477, .950067, .246691, .488081}, Known{30, .365579, .969209, .288601, .624938}}) {
    const Image map = flip_difference(reference, test, {.pixels_per_degree = k.ppd});
    const auto at = [&](int x, int y) { return double(map.values[map.index(x, y)]); };
    EXPECT_NEAR(image_mean(map), k.mean, 2e-5);
    EXPECT_NEAR(at(24, 12), k.blot, 1e-4);
    EXPECT_NEAR(at(5, 5), k.corner, 1e-4);
    EXPECT_NEAR(at(47, 31), k.last, 1e-4);
    const double other = image_mean(flip_difference(reference, test, {.pixels_per_degree = 1.01 * k.ppd}));
    EXPECT_GT(std::abs(other - k.mean), 2e-5) << "the twin: an eye one per cent off";
  }
}

TEST(Flip, ToneMapsAndRefuses) {
  const Image bright = plain(4, 4, 4), brighter = plain(8, 8, 8);
  EXPECT_EQ(image_mean(flip_difference(bright, brighter)), 0) << "both are clipped";
  EXPECT_GT(image_mean(flip_difference(bright, brighter, {.exposure = -3})), .1);
  EXPECT_THROW(flip_difference(bright, make_image(3, 3, {"R", "G", "B"})), Error);
  EXPECT_THROW(flip_difference(make_image(3, 3, {"Y"}), make_image(3, 3, {"Y"})), Error);
}

}  // namespace
}  // namespace reflectree
