// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/chi_square.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "reflectree/verify/faults.hpp"
#include "simple_samplers.hpp"

namespace reflectree {
namespace {

const CosineSampler<Lambert> lambert{{{0.5f, 0.5f, 0.5f}}};
const LowSmoothSampler smooth{low_smooth(300)};
const LowSmoothSampler needle{low_smooth(1e6f)};
const CosineSampler<LowSmooth> loose{low_smooth(5)};  // weights vary by a factor of six

TEST(Bins, HaveNearlyEqualMassAndTheRightSum) {
  for (const float b : {3.f, 300.f, 1e6f}) {
    const LowSmooth f = low_smooth(b);
    for (const double theta : {0., 45., 85., 89.9}) {
      const Direction wo = direction_at(theta, 20);
      const Bins bins = equal_mass_bins(target_function(f), wo);
      ASSERT_EQ(bins.mass.size(), 400u);
      const double exact = std::sqrt(1 + 0.25 + 0.0625) * low_smooth_albedo(1, double(b), double(wo.z));
      EXPECT_NEAR(bins.total / exact, 1, 1e-4) << b << ' ' << theta;
      EXPECT_LT(*std::max_element(bins.mass.begin(), bins.mass.end()), 2.2 * bins.total / 400)
          << b << ' ' << theta;
      EXPECT_GT(*std::min_element(bins.mass.begin(), bins.mass.end()), 0.15 * bins.total / 400)
          << b << ' ' << theta;
    }
  }
}

TEST(Bins, FindAgreesWithTheBoxes) {
  const Bins bins = equal_mass_bins(target_function(low_smooth(300)), direction_at(50, 120));
  for (std::size_t i = 0; i < bins.boxes.size(); ++i) {
    const CubatureBox& r = bins.boxes[i];
    const auto w = bins.chart.direction({linear_mix(0.5, r.x0, r.x1), linear_mix(0.5, r.y0, r.y1)}).w;
    EXPECT_EQ(bins.find({float(w.x), float(w.y), float(w.z)}), i);
  }
}

constexpr double elevations_deg[] = {0, 30, 60, 85, 89};

// Exact samplers pass at every angle, in one family.
TEST(ChiSquare, PassesExactSamplers) {
  ChiSquareOptions options;
  options.tests = 3 * int(std::size(elevations_deg));
  for (const double theta : elevations_deg) {
    const Direction wo = direction_at(theta, 10);
    const auto pass = [&](const ErasedSampler& sampler, const TargetFunction& f) {
      const Bins bins = equal_mass_bins(f, wo);
      const Tally tally = tally_of(sampler, bins, options);
      EXPECT_TRUE(check_counts(tally, bins, options).passed)
          << theta << to_line(check_counts(tally, bins, options));
      EXPECT_TRUE(check_weights(tally, bins, options).passed)
          << theta << to_line(check_weights(tally, bins, options));
      const CheckResult mean = check_mean_weight(tally, bins, options);
      EXPECT_TRUE(mean.passed) << theta << to_line(mean);
      EXPECT_LT(relative_variance(tally), 1e-6);
    };
    pass(erase(lambert), target_function(lambert.f));
    pass(erase(smooth), target_function(smooth.f));
    pass(erase(needle), target_function(needle.f));
  }
}

// A sampler whose density is not the function's passes by its own pdf and by its weights, not by f.
TEST(ChiSquare, JudgesOneShotSamplersByTheirOwnDensity) {
  ChiSquareOptions options;
  const Direction wo = direction_at(40);
  const ErasedSampler sampler = erase(loose);
  const Bins bins = equal_mass_bins(target_function(loose.f), wo);
  const auto density = density_masses(sampler, bins);
  const Tally tally = tally_of(sampler, bins, options);
  EXPECT_TRUE(check_counts(tally, density, options).passed) << to_line(check_counts(tally, density, options));
  EXPECT_TRUE(check_weights(tally, bins, options).passed) << to_line(check_weights(tally, bins, options));
  EXPECT_TRUE(check_mean_weight(tally, bins, options).passed)
      << to_line(check_mean_weight(tally, bins, options));
  EXPECT_FALSE(check_counts(tally, bins, options).passed);
  EXPECT_GT(relative_variance(tally), 0.1);

  double integral = 0;
  for (const double m : density) integral += m;
  EXPECT_NEAR(integral, 1, 1e-3);
}

// The twins, at the level of a family of a thousand tests.
TEST(ChiSquareTwin, FaultsOfExactSamplersAreRejected) {
  ChiSquareOptions options;
  options.tests = 1000;
  const auto rejected = [&](const ErasedSampler& sampler, const TargetFunction& f, Direction wo) {
    const Bins bins = equal_mass_bins(f, wo);
    return !check_counts(tally_of(sampler, bins, options), bins, options).passed;
  };
  for (const double theta : {0., 45., 85.}) {
    const Direction wo = direction_at(theta);
    const Direction mirror{-wo.x, -wo.y, wo.z};
    for (const auto* low : {&smooth, &needle}) {
      const TargetFunction f = target_function(low->f);
      const ErasedSampler s = erase(*low);
      EXPECT_TRUE(rejected(bent(s, 1, 0.02), f, wo)) << theta;
      EXPECT_TRUE(rejected(bent(s, 1, -0.02), f, wo)) << theta;
      if (theta < 80) {
        EXPECT_TRUE(rejected(bent(s, 0, 0.02, mirror), f, wo)) << theta;
      }
      // A cone that holds about two per cent of a 1 / (1 + b d^2) lobe around its axis.
      const double radius2 = 0.2 / double(low->f.b);
      EXPECT_TRUE(rejected(lost_support(s, mirror, float(1 - radius2 / 2)), f, wo)) << theta;
      LowSmooth wrong = low->f;
      wrong.b *= 1.1f;
      EXPECT_TRUE(rejected(erase(LowSmoothSampler{wrong}), f, wo)) << theta;
    }
    const TargetFunction f = target_function(lambert.f);
    EXPECT_TRUE(rejected(bent(erase(lambert), 0, 0.02), f, wo));
    EXPECT_TRUE(rejected(bent(erase(lambert), 1, 0.02), f, wo));
    EXPECT_TRUE(rejected(bent(erase(lambert), 2, 0.02, {0, 0, 0.7f}), f, wo));
    EXPECT_TRUE(rejected(lost_support(erase(lambert), direction_at(30, 60), 0.99f), f, wo));
  }
}

TEST(ChiSquareTwin, FaultsOfOneShotSamplersAreRejected) {
  ChiSquareOptions options;
  options.tests = 1000;
  const Direction wo = direction_at(40);
  const Bins bins = equal_mass_bins(target_function(loose.f), wo);
  const auto density = density_masses(erase(loose), bins);
  for (const auto& faulty : {bent(erase(loose), 1), bent(erase(loose), 0),
                             lost_support(erase(loose), direction_at(30, 60), 0.99f)}) {
    const Tally tally = tally_of(faulty, bins, options);
    EXPECT_FALSE(check_counts(tally, density, options).passed) << faulty.name;
    EXPECT_FALSE(check_weights(tally, bins, options).passed) << faulty.name;
  }
  // A false weight leaves the counts as they are; only the weights tell.
  const Tally heavy = tally_of(scaled_weight(erase(loose), 1.02f), bins, options);
  EXPECT_TRUE(check_counts(heavy, density, options).passed);
  EXPECT_FALSE(check_weights(heavy, bins, options).passed);
  EXPECT_FALSE(check_mean_weight(heavy, bins, options).passed);
  const Tally light =
      tally_of(scaled_weight(erase(smooth), 0.999f), equal_mass_bins(target_function(smooth.f), wo));
  EXPECT_FALSE(check_mean_weight(light, equal_mass_bins(target_function(smooth.f), wo)).passed);
}

// Swapped arguments are invisible for a reciprocal function and seen for any other.
TEST(ChiSquareTwin, SwappedArgumentsAreRejected) {
  const auto tilted = [](Direction wo, Direction wi) { return 1 + 0.5f * wi.x - 0.3f * wo.z * wi.y; };
  const Direction wo = direction_at(40, 30);
  const CosineSampler<decltype(tilted)> sampler{tilted};
  const Bins right = equal_mass_bins(target_function(tilted), wo);
  const TargetFunction f = target_function(tilted);
  const Bins wrong = equal_mass_bins(swapped(f), wo);
  const Tally a = tally_of(erase(sampler), right), b = tally_of(erase(sampler), wrong);
  EXPECT_TRUE(check_weights(a, right).passed) << to_line(check_weights(a, right));
  EXPECT_FALSE(check_weights(b, wrong).passed);
}

TEST(ChiSquareTwin, DirectionsBelowTheHorizonFail) {
  const Direction wo = direction_at(40);
  ErasedSampler s = erase(lambert);
  s.sample = [inner = s.sample](Direction w, Pcg32& u, DrawnDirection& out) {
    const bool drawn = inner(w, u, out);
    if (u() < 40000) out.wi.z = -out.wi.z;  // one of a hundred thousand
    return drawn;
  };
  const Bins bins = equal_mass_bins(target_function(lambert.f), wo);
  const Tally tally = tally_of(s, bins);
  EXPECT_GT(tally.invalid, 0u);
  EXPECT_FALSE(check_counts(tally, bins).passed);
  EXPECT_FALSE(check_weights(tally, bins).passed);
}

// Over many seeds the p-values of a right sampler are uniform: the test neither cries wolf nor sleeps.
TEST(ChiSquare, PValuesAreUniform) {
  const Direction wo = direction_at(50);
  const Bins bins = equal_mass_bins(target_function(smooth.f), wo);
  const auto density = density_masses(erase(smooth), bins);
  std::vector<double> counts, weights;
  constexpr int runs = 200;
  for (int run = 0; run < runs; ++run) {
    ChiSquareOptions options;
    options.samples = 50'000;
    options.seed = std::uint64_t(run) + 100;
    const Tally tally = tally_of(erase(smooth), bins, options);
    counts.push_back(check_counts(tally, density, options).p_value);
    weights.push_back(check_weights(tally, bins, options).p_value);
  }
  for (auto* list : {&counts, &weights}) {
    std::sort(list->begin(), list->end());
    double distance = 0;  // Kolmogorov-Smirnov; 1.95 / sqrt(n) has p = 1e-3
    for (int i = 0; i < runs; ++i)
      distance = std::max(distance, std::abs((*list)[std::size_t(i)] - (i + 0.5) / runs));
    EXPECT_LT(distance, 1.95 / std::sqrt(runs));
  }
}

// Eight tests with a p of 0.01 each tell together what none tells alone; uniform ones tell nothing.
TEST(ChiSquare, WeakTestsTellTogether) {
  const std::vector<double> weak(8, 0.01), uniform{0.9, 0.3, 0.5, 0.1, 0.7, 0.02, 0.99, 0.6};
  EXPECT_NEAR(check_together("together", weak).statistic, 2.3263 * std::sqrt(8.), 1e-3);
  EXPECT_FALSE(check_together("together", weak).passed);
  EXPECT_TRUE(check_together("together", uniform).passed);
}

TEST(ChiSquare, ResultsDoNotDependOnThreads) {
  const Direction wo = direction_at(50);
  const Host host = threaded_host();
  const Bins a = equal_mass_bins(target_function(loose.f), wo),
             b = equal_mass_bins(target_function(loose.f), wo, {}, host);
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.boxes, b.boxes);
  const ErasedSampler sampler = erase(loose);
  EXPECT_EQ(density_masses(sampler, a), density_masses(sampler, b, 1e-3, host));
  ChiSquareOptions options;
  options.samples = 200'001;
  const Tally s = tally_of(sampler, a, options), t = tally_of(sampler, b, options, host);
  EXPECT_EQ(s.count, t.count);
  EXPECT_EQ(s.weight, t.weight);
  EXPECT_EQ(s.weight2, t.weight2);
  EXPECT_EQ(s.samples, 200'001u);
}

TEST(ChiSquare, OfABlackSurfaceWantsNoSample) {
  const auto black = [](Direction, Direction) { return 0.f; };
  const Bins bins = equal_mass_bins(target_function(black), direction_at(20));
  EXPECT_TRUE(bins.mass.empty());
  ErasedSampler none;
  none.sample = [](Direction, Pcg32&, DrawnDirection&) { return false; };
  EXPECT_TRUE(check_counts(tally_of(none, bins), bins).passed);
  EXPECT_FALSE(check_counts(tally_of(erase(lambert), bins), bins).passed);
}

}  // namespace
}  // namespace reflectree
