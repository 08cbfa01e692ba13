// SPDX-License-Identifier: Apache-2.0
// Every row of the table in fast_functions.hpp, beside the library in double.
#include "reflectree/math/fast_functions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace reflectree {
namespace {

constexpr double pi_d = pi_v<double>;

// The largest distance of a point from {cos, sin} of phi(t), over t in [lo, hi].
template <class F, class Phi>
double worst_point(float lo, float hi, const F& f, const Phi& phi) {
  double worst = 0;
  constexpr int steps = 1 << 21;
  for (int i = 0; i <= steps; ++i) {
    const float t = std::min(lo + (hi - lo) * (float(i) / steps), hi);
    const Vec2<float> p = f(t);
    worst = std::max({worst, std::abs(double(p.x) - std::cos(phi(double(t)))),
                      std::abs(double(p.y) - std::sin(phi(double(t))))});
  }
  return worst;
}

template <class F, class Right>
double worst_ratio(float lo, float hi, const F& f, const Right& right) {
  double worst = 0;
  constexpr int steps = 1 << 21;
  for (int i = 0; i <= steps; ++i) {
    const float t = lo + (hi - lo) * (float(i) / steps);
    const double r = right(double(t));
    if (r != 0) worst = std::max(worst, std::abs(double(f(t)) - r) / std::abs(r));
  }
  return worst;
}

TEST(FastFunctions, PointsOfTheCircle) {
  EXPECT_LT(worst_point(
                -1, 1, [](float t) { return cos_sin_quarter(t); }, [](double t) { return pi_d / 4 * t; }),
            1.2e-7);
  EXPECT_LT(worst_point(
                -1, 1, [](float t) { return cos_sin_half(t); }, [](double t) { return pi_d / 2 * t; }),
            2e-7);
  EXPECT_LT(worst_point(
                0, 1, [](float t) { return on_circle(t); }, [](double t) { return 2 * pi_d * t; }),
            1.2e-7);
}

TEST(FastFunctions, QuartersAreExact) {
  EXPECT_EQ(on_circle(0), (Vec2<float>{1, 0}));
  EXPECT_EQ(on_circle(.25f), (Vec2<float>{0, 1}));
  EXPECT_EQ(on_circle(.5f), (Vec2<float>{-1, 0}));
  EXPECT_EQ(on_circle(.75f), (Vec2<float>{0, -1}));
  EXPECT_EQ(on_circle(1), (Vec2<float>{1, 0}));
}

TEST(FastFunctions, ArcTangents) {
  EXPECT_LT(
      worst_ratio(
          -1, 1, [](float t) { return quarter_atan(t); }, [](double t) { return 4 / pi_d * std::atan(t); }),
      3e-7);
  // Around the circle, at several radii.
  double first = 0, full = 0, polar = 0;
  for (const float radius : {1e-12f, 1e-3f, 1.f, 1e6f}) {
    for (int i = 0; i < 400'000; ++i) {
      const double phi = 2 * pi_d * (double(i) + 0.5) / 400'000 - pi_d;
      const float x = radius * float(std::cos(phi)), y = radius * float(std::sin(phi));
      const auto miss = [](float a, double right) { return std::abs(double(a) - right) / std::abs(right); };
      full = std::max(full, miss(angle_of(y, x), std::atan2(double(y), double(x))));
      const float ax = abs(x), ay = abs(y);
      first = std::max(first, miss(first_quadrant_angle(ay, ax), std::atan2(double(ay), double(ax))));
      if (radius != 1) continue;
      const float s2 = y * y;
      polar = std::max(polar, miss(polar_angle(s2, ax), std::atan2(std::sqrt(double(s2)), double(ax))));
    }
  }
  EXPECT_LT(first, 3e-7);
  EXPECT_LT(full, 3e-7);
  EXPECT_LT(polar, 3e-7);
  EXPECT_EQ(angle_of(0, 0), 0);
}

TEST(FastFunctions, Exponential) {
  EXPECT_LT(worst_ratio(
                -87, 0, [](float x) { return exp_of_negative(x); }, [](double x) { return std::exp(x); }),
            1.5e-7);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(exp_of_negative(0), 1);
  EXPECT_EQ(exp_of_negative(-infinity), 0);
  EXPECT_EQ(exp_of_negative(-90), std::exp(-90.f));
  EXPECT_TRUE(std::isnan(exp_of_negative(std::numeric_limits<float>::quiet_NaN())));
}

TEST(FastFunctions, Logarithm) {
  const auto fast = [](float x) { return log_of_positive(x); };
  const auto right = [](double x) { return std::log(x); };
  EXPECT_LT(worst_ratio(0.5f, 2, fast, right), 2.5e-7);
  EXPECT_LT(worst_ratio(0.99f, 1.01f, fast, right), 2.5e-7);
  // Over all normal numbers, evenly in their logarithm.
  const auto at = [](float x) { return log_of_positive(std::bit_cast<float>(std::uint32_t(x))); };
  const auto right_at = [](double x) { return std::log(double(std::bit_cast<float>(std::uint32_t(x)))); };
  EXPECT_LT(worst_ratio(0x1p23f, 254 * 0x1p23f, at, right_at), 2.5e-7);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(log_of_positive(1), 0);
  EXPECT_EQ(log_of_positive(0), -infinity);
  EXPECT_EQ(log_of_positive(infinity), infinity);
  EXPECT_EQ(log_of_positive(1e-40f), std::log(1e-40f));
  EXPECT_TRUE(std::isnan(log_of_positive(-1)));
  EXPECT_TRUE(std::isnan(log_of_positive(std::numeric_limits<float>::quiet_NaN())));
}

}  // namespace
}  // namespace reflectree
