// SPDX-License-Identifier: Apache-2.0
// Faults planted in a sampler's data: the chi-square test and the counters must see them.
#include <gtest/gtest.h>

#include <algorithm>

#include "functions.hpp"
#include "reflectree/verify/faults.hpp"

namespace reflectree {
namespace {

const AnyBrdf& plastic() {
  static const AnyBrdf f = material("plastic:kd=0.5,alpha=0.2");
  return f;
}
const SamplerData& good_data() {
  static const SamplerData data = build(plastic());
  return data;
}

std::size_t slab_of(const Partition& partition, double theta_deg) {
  const float theta = float(theta_deg * pi_v<double> / 180);
  return find_slab(partition, {&theta, 1});
}
std::size_t heaviest(const CanonicalTree& tree) {
  return std::size_t(std::max_element(tree.mass.begin(), tree.mass.end()) - tree.mass.begin());
}

// Changes one mass of an exact tree and leaves every other bound as it was.
void set_mass(MajorantTree& tree, std::size_t leaf, std::uint32_t mass) {
  double before = 0, after = 0;
  for (const std::uint32_t m : tree.mass) before += m;
  tree.mass[leaf] = mass;
  for (const std::uint32_t m : tree.mass) after += m;
  tree.volume = float(double(tree.volume) * after / before);
}

bool exact_passes(const SamplerData& data, double theta, SampleStatistics* statistics = nullptr) {
  const auto s = make_sampler(plastic(), data);
  ChiSquareOptions options;
  options.tests = 1000;
  const Bins bins = equal_mass_bins(target_function(plastic()), wo_at(theta));
  if (statistics) {
    Pcg32 u(1);
    for (int i = 0; i < 100'000; ++i) s.exact.sample(wo_at(theta), u, *statistics);
  }
  return check_counts(tally_of(erase(s.exact), bins, options), bins, options).passed;
}

constexpr double elevations_deg[] = {10, 50, 80};

TEST(Faults, TheSoundSamplerPasses) {
  for (const double theta : elevations_deg) {
    SampleStatistics statistics;
    EXPECT_TRUE(exact_passes(good_data(), theta, &statistics));
    EXPECT_LT(statistics.overshoot_sum / double(statistics.trials), 1e-6);
  }
}

TEST(FaultsTwin, TheHeaviestLeafsBoundHalved) {
  for (const double theta : elevations_deg) {
    SamplerData data = good_data();
    MajorantTree& tree = data.exact[slab_of(data.exact_partition, theta)];
    const std::size_t leaf = heaviest(tree);
    set_mass(tree, leaf, tree.mass[leaf] / 2);
    SampleStatistics statistics;
    EXPECT_FALSE(exact_passes(data, theta, &statistics)) << theta;
    EXPECT_GT(statistics.overshoots, 1000u) << theta;
    EXPECT_GT(statistics.worst_overshoot, 0.5f) << theta;
  }
}

TEST(FaultsTwin, ALeafThatLostItsSupport) {
  for (const double theta : elevations_deg) {
    SamplerData data = good_data();
    MajorantTree& tree = data.exact[slab_of(data.exact_partition, theta)];
    set_mass(tree, heaviest(tree), 1);  // 0 is refused by validate
    EXPECT_FALSE(exact_passes(data, theta)) << theta;
  }
}

TEST(FaultsTwin, AWrongSlab) {
  SamplerData data = good_data();
  // The bounds of another elevation.
  std::swap(data.exact.front(), data.exact.back());
  SampleStatistics statistics;
  EXPECT_FALSE(exact_passes(data, 10, &statistics));
  EXPECT_GT(statistics.overshoots, 0u);
}

double mean_of_x(const ExactSampler<AnyBrdf>& s, Direction wo) {
  Pcg32 u(4);
  double sum = 0;
  for (int i = 0; i < 20'000; ++i) sum += double(s.sample(wo, u)->wi.x) / 20'000;
  return sum;
}

TEST(FaultsTwin, BentByTwoPerCent) {
  const auto s = make_sampler(plastic(), good_data());
  ChiSquareOptions options;
  options.tests = 1000;
  for (const double theta : elevations_deg) {
    const Direction wo = wo_at(theta);
    const Bins bins = equal_mass_bins(target_function(plastic()), wo);
    const auto passes = [&](const ErasedSampler& sampler) {
      const Tally tally = tally_of(sampler, bins, options);
      return check_counts(tally, bins, options).passed;
    };
    const ErasedSampler exact = erase(s.exact);
    // Pivots about which both signs are frequent: left and right, and either side of the mean direction.
    const float mean_x = float(mean_of_x(s.exact, wo));
    for (const double amount : {0.02, -0.02}) {
      EXPECT_FALSE(passes(bent(exact, 0, amount, {mean_x, 0, 0}))) << theta;
      EXPECT_FALSE(passes(bent(exact, 1, amount))) << theta;
    }
    // One-shot: the weights betray the bend.
    const Tally tally = tally_of(bent(erase(s.one_shot), 1, 0.02), bins, options);
    EXPECT_FALSE(check_weights(tally, bins, options).passed) << theta;
    // One-shot is right whatever its tree says.
    SamplerData data = good_data();
    CanonicalTree& tree = data.one_shot[slab_of(data.one_shot_partition, theta)];
    tree.mass[heaviest(tree)] /= 2;
    const auto other = make_sampler(plastic(), data);
    const Tally loose = tally_of(erase(other.one_shot), bins, options);
    EXPECT_TRUE(check_weights(loose, bins, options).passed) << to_line(check_weights(loose, bins, options));
    EXPECT_GT(relative_variance(loose), 2 * relative_variance(tally_of(erase(s.one_shot), bins, options)));
  }
}

// wo and wi exchanged: seen for a function that is not reciprocal.
TEST(FaultsTwin, SwappedArguments) {
  const AnyBrdf f = [](Direction wo, Direction wi) { return 0.1f + 0.2f * wo.z * wi.z * wi.z; };
  const auto s = make_sampler(f);
  const Direction wo = wo_at(50);
  const auto right = judge(s, target_function(f), wo), wrong = judge(s, swapped(target_function(f)), wo);
  EXPECT_TRUE(all_passed(right)) << to_text(right);
  for (const CheckResult& r : wrong) EXPECT_FALSE(r.passed) << to_line(r);
}

}  // namespace
}  // namespace reflectree
