// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/attack.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simple_samplers.hpp"

namespace reflectree {
namespace {

// A bound of 1 that holds but for a needle of radius `width` at a secret place.
RatioFunction hidden_needle(double width, double height) {
  return [=](std::span<const AttackPoint> points, std::span<double> out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& p = points[i];
      const double d2 = sqr(p[0] - 0.317) + sqr(p[1] - 0.664) + sqr(p[2] - 0.129);
      out[i] =
          0.8 + 0.1 * std::cos(7 * p[0]) * std::cos(9 * p[1]) + height * std::exp(-d2 / (2 * width * width));
    }
  };
}

TEST(Attack, FindsANeedleBetweenTheProbes) {
  const AttackResult r = attack(hidden_needle(0.01, 1));
  EXPECT_GT(r.worst, 1.74);
  EXPECT_NEAR(r.at[0], 0.317, 1e-3);
  EXPECT_GT(r.overshoots, 0u);
  const AttackResult t = attack(hidden_needle(0.01, 1), {}, threaded_host());
  EXPECT_EQ(r.worst, t.worst);
  EXPECT_EQ(r.evaluations, t.evaluations);
}

TEST(Attack, ReachesASmoothMaximum) {
  const AttackResult r = attack(hidden_needle(0.01, 0));
  EXPECT_NEAR(r.worst, 0.9, 1e-9);
  EXPECT_EQ(r.overshoots, 0u);
}

TEST(Attack, ClimbsToAMaximumOnTheBorder) {
  const auto slope = [](std::span<const AttackPoint> points, std::span<double> out) {
    for (std::size_t i = 0; i < points.size(); ++i)
      out[i] = points[i][0] * points[i][1] + 0.01 * points[i][2];
  };
  EXPECT_NEAR(attack(slope).worst, 1.01, 1e-6);
}

TEST(OvershootMass, IsEstimatedAndBounded) {
  // Ratio uniform in [0, 1], but 1 + 0.5 u in one of 10^4 trials: mass 0.25e-4 of the mean 0.5.
  const auto trial = [](Pcg32& u) {
    const double x = to_unit_double(u());
    return to_unit_double(u()) < 1e-4 ? 1 + 0.5 * x : x;
  };
  const double exact = 0.25e-4 / (0.5 * (1 - 1e-4) + 1.25e-4);
  int missed = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const OvershootMass m = overshoot_mass(trial, 300'000, 1.5, seed);
    missed += m.upper < exact;
    EXPECT_LT(m.upper, 6 * exact);
    EXPECT_NEAR(m.estimate, exact, exact);
  }
  EXPECT_LE(missed, 5);  // 5 % of 40, and three standard deviations
  EXPECT_FALSE(check_overshoot(overshoot_mass(trial, 300'000, 1.5), 1e-6).passed);
}

TEST(OvershootMass, WithoutOvershootsFallsAsOneOverTheTrials) {
  const auto trial = [](Pcg32& u) { return to_unit_double(u()); };
  const OvershootMass m = overshoot_mass(trial, 4'000'000, 1.1);
  EXPECT_EQ(m.overshoots, 0u);
  EXPECT_EQ(m.estimate, 0);
  EXPECT_NEAR(m.upper, -std::log(0.025) / 4e6 * 0.1 / 0.5, 1e-8);
  EXPECT_TRUE(check_overshoot(m, 1e-6).passed);
  EXPECT_EQ(overshoot_mass(trial, 4'000'000, 1.1, 1, threaded_host()).upper, m.upper);
}

}  // namespace
}  // namespace reflectree
