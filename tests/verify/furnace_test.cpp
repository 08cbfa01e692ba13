// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/furnace.hpp"

#include <gtest/gtest.h>

#include "simple_samplers.hpp"

namespace reflectree {
namespace {

const LowSmoothSampler smooth{low_smooth(300)};
const double norm = std::sqrt(1 + 0.25 + 0.0625);

TEST(Furnace, TheClosedFormIsARightTable) {
  const auto table = [](Direction wo) { return norm * low_smooth_albedo(1, 300, double(wo.z)); };
  const TargetFunction f = target_function(smooth.f);
  const CheckResult r = check_albedo_table(table, f);
  EXPECT_TRUE(r.passed) << to_line(r);
  EXPECT_LT(r.statistic, 0.2);
  EXPECT_EQ(check_albedo_table(table, f, {}, threaded_host()).statistic, r.statistic);
}

TEST(FurnaceTwin, WrongTablesAreRejected) {
  const TargetFunction f = target_function(smooth.f);
  const auto scaled = [](Direction wo) { return 1.00015 * norm * low_smooth_albedo(1, 300, double(wo.z)); };
  EXPECT_FALSE(check_albedo_table(scaled, f).passed);
  // Right everywhere but at the very horizon.
  const auto grazing = [](Direction wo) {
    return (wo.z < 1e-4f ? 1.002 : 1) * norm * low_smooth_albedo(1, 300, double(wo.z));
  };
  EXPECT_FALSE(check_albedo_table(grazing, f).passed);
  const auto nan = [](Direction) { return std::nan(""); };
  EXPECT_FALSE(check_albedo_table(nan, f).passed);
}

// One trial of rejection under the constant bound of the lobe's peak: volume pi, accepted with probability f.
TEST(Furnace, AcceptedTrialsEstimateTheAlbedo) {
  const TargetFunction f = target_function(smooth.f);
  const auto trial = [](double factor) {
    return [factor](Direction wo, Pcg32& u) {
      const double r = std::sqrt(to_unit_double(u())), phi = 2 * pi_v<double> * to_unit_double(u());
      const double x = r * std::cos(phi) + double(wo.x), y = r * std::sin(phi) + double(wo.y);
      return to_unit_double(u()) < 1 / (1 + 300 * (x * x + y * y)) ? factor * norm * pi_v<double> : 0;
    };
  };
  const Direction wo = direction_at(60, 25);
  const CheckResult right = check_albedo_estimates("trials", trial(1), f, wo, 4'000'000);
  EXPECT_TRUE(right.passed) << to_line(right);
  const CheckResult wrong = check_albedo_estimates("trials", trial(1.05), f, wo, 4'000'000);
  EXPECT_FALSE(wrong.passed) << to_line(wrong);
  EXPECT_EQ(check_albedo_estimates("trials", trial(1), f, wo, 100'001, 1, threaded_host()).statistic,
            check_albedo_estimates("trials", trial(1), f, wo, 100'001).statistic);
}

}  // namespace
}  // namespace reflectree
