// SPDX-License-Identifier: Apache-2.0
// The paper's sampler draws what it claims, in every variant.
#include "reflectree/peers/paper_sampler.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "allocations.hpp"
#include "paper_fixture.hpp"
#include "reflectree/error.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/consistency.hpp"
#include "reflectree/verify/faults.hpp"
#include "reflectree/verify/reference.hpp"

namespace reflectree {
namespace {

Tally tally(const PaperSampler& sampler, const Bins& bins, const ChiSquareOptions& options) {
  const ErasedSampler erased = erase(sampler);
  return tally_of(erased, bins, options);
}

struct Variant {
  PaperMap map;
  PaperChoice choice;
  bool retry_from_root;
};
constexpr Variant variants[] = {
    {PaperMap::disk, PaperChoice::cdf, false},        {PaperMap::disk, PaperChoice::cdf, true},
    {PaperMap::disk, PaperChoice::warp, false},       {PaperMap::disk, PaperChoice::alias, false},
    {PaperMap::equal_area, PaperChoice::alias, true}, {PaperMap::half_vector, PaperChoice::cdf, false},
    {PaperMap::half_vector, PaperChoice::warp, true}};
PaperOptions options_of(const Variant& v) {
  PaperOptions options;
  options.grid = 32;
  options.map = v.map, options.choice = v.choice, options.retry_from_root = v.retry_from_root;
  options.negligible = 1e-3;
  return options;
}

// Fine estimates, one wo: the density is proportional to f, by every map, choice and way of retrying.
TEST(PaperSampler, DrawsInProportionToTheFunction) {
  const AnyBrdf f = brdf("plastic:alpha=0.4");
  const Direction wo = at(40);
  const Bins bins = equal_mass_bins(target_function(f), wo, {100, 1e-3});
  ChiSquareOptions chi;
  chi.samples = 100'000;
  chi.tests = int(std::size(variants));
  for (const Variant& v : variants) {
    const PaperOptions options = options_of(v);
    const PaperSampler sampler(f, {}, wo, options);
    const CheckResult counts = check_counts(tally(sampler, bins, chi), bins, chi);
    EXPECT_TRUE(counts.passed) << &v - variants << " " << to_line(counts);

    const PaperSampler twin(f, {}, {spoiled(sampler.trees()[0], options)}, true, options);
    const CheckResult rejected = check_counts(tally(twin, bins, chi), bins, chi);
    EXPECT_FALSE(rejected.passed) << &v - variants << " " << to_line(rejected);
  }
}

// Between tabulated elevations, tables far apart: directions follow the pdf, weighted they are the target.
TEST(PaperSampler, BetweenItsTablesTheWeightCarriesTheRest) {
  const AnyBrdf f = brdf("ashikhmin_shirley:n_x=50,n_y=50,kd=0.02");
  const Direction wo = at(6.9 * 90. / 8);
  const Bins bins = equal_mass_bins(target_function(f), wo, {100, 1e-3});
  ChiSquareOptions chi;
  chi.samples = 100'000;
  chi.tests = 9;
  double variance[2] = {};
  for (const PaperBetween between : {PaperBetween::nearest, PaperBetween::mixed}) {
    for (const PaperMap map : {PaperMap::disk, PaperMap::equal_area, PaperMap::half_vector}) {
      PaperOptions options = options_of({map, PaperChoice::cdf, false});
      options.thetas = 8, options.between = between;
      // One table's half vectors do not reach the whole hemisphere of another wo: support is lost.
      if (map == PaperMap::half_vector && between == PaperBetween::nearest) continue;
      const PaperSampler sampler(f, {}, options);
      const Tally drawn = tally(sampler, bins, chi);
      const CheckResult weights = check_weights(drawn, bins, chi);
      EXPECT_TRUE(weights.passed) << int(between) << int(map) << " " << to_line(weights);
      const CheckResult mean = check_mean_weight(drawn, bins, chi, 3e-3);
      EXPECT_TRUE(mean.passed) << int(between) << int(map) << " " << to_line(mean);
      if (map == PaperMap::disk) variance[int(between)] = relative_variance(drawn);

      std::vector<PaperTree> trees = sampler.trees();
      for (PaperTree& tree : trees) tree.nodes[0].integral *= 1.02;  // a wrong normaliser
      const PaperSampler twin(f, {}, trees, false, options);
      EXPECT_FALSE(check_mean_weight(tally(twin, bins, chi), bins, chi, 3e-3).passed);
      const Tally bent_tally = tally_of(bent(erase(sampler), 1, 0.2), bins, chi);
      EXPECT_FALSE(check_weights(bent_tally, bins, chi).passed) << int(between) << int(map);
    }
  }
  EXPECT_LT(variance[1], 0.5 * variance[0]);
}

// The same between tabulated azimuths; a twin whose trees stand a step of azimuth aside, and one that bends.
TEST(PaperSampler, TabulatesAzimuthsOfAnisotropicFunctions) {
  const AnyBrdf f = brdf("plastic:alpha_x=0.2,alpha_y=0.5,phi_deg=20");
  const Direction wo = direction_from_angles(0.9f, 2.2f);
  const Bins bins = equal_mass_bins(target_function(f), wo, {100, 1e-3});
  ChiSquareOptions chi;
  chi.samples = 100'000;
  chi.tests = 2;
  double variance[2] = {};
  for (const PaperBetween between : {PaperBetween::nearest, PaperBetween::mixed}) {
    PaperOptions options = options_of({PaperMap::disk, PaperChoice::cdf, false});
    options.thetas = 12, options.phis = 12, options.between = between;
    const PaperSampler sampler(f, {}, options);
    const Tally drawn = tally(sampler, bins, chi);
    const CheckResult weights = check_weights(drawn, bins, chi);
    EXPECT_TRUE(weights.passed) << int(between) << " " << to_line(weights);
    const CheckResult mean = check_mean_weight(drawn, bins, chi, 3e-3);
    EXPECT_TRUE(mean.passed) << int(between) << " " << to_line(mean);
    variance[int(between)] = relative_variance(drawn);
    ConsistencyOptions consistency;
    consistency.samples = 2000, consistency.integral_tolerance = 1e-2, consistency.max_none = 1e-2;
    for (const CheckResult& r : check_consistency(erase(sampler), target_function(f), wo, consistency)) {
      EXPECT_TRUE(r.passed) << int(between) << " " << to_line(r);
    }

    std::vector<PaperTree> trees = sampler.trees();
    std::rotate(trees.begin(), trees.begin() + options.thetas, trees.end());
    for (std::size_t i = 0; i < trees.size(); ++i) trees[i].wo = sampler.trees()[i].wo;
    const PaperSampler twin(f, {}, trees, false, options);
    EXPECT_FALSE(check_mean_weight(tally(twin, bins, chi), bins, chi, 3e-3).passed &&
                 check_weights(tally(twin, bins, chi), bins, chi).passed);
    const Tally bent_tally = tally_of(bent(erase(sampler), 1, 0.2), bins, chi);
    EXPECT_FALSE(check_weights(bent_tally, bins, chi).passed) << int(between);
  }
  EXPECT_LT(variance[1], variance[0]);
  PaperOptions one;
  one.thetas = 2;
  EXPECT_THROW(PaperSampler(f, {}, one), Error);
}

TEST(PaperSampler, IsConsistent) {
  const AnyBrdf f = brdf("plastic:alpha=0.3");
  const TargetFunction t = target_function(f);
  ConsistencyOptions consistency;
  consistency.samples = 3000;
  consistency.integral_tolerance = 1e-2;  // I is an estimate
  consistency.max_none = 1e-2;
  for (const Variant& v : {variants[0], variants[6]}) {
    const PaperSampler sampler(f, {}, options_of(v));
    for (const Direction wo : {at(30), direction_from_angles(1.2f, 2.f)}) {
      for (const CheckResult& r : check_consistency(erase(sampler), t, wo, consistency)) {
        EXPECT_TRUE(r.passed) << to_line(r);
      }
      EXPECT_FALSE(all_passed(check_consistency(scaled_pdf(erase(sampler), 1.02f), t, wo, consistency)));
    }
  }
}

// N at once: all of them, with the right mean, turned with wo, and nothing allocated.
TEST(PaperSampler, DrawsManyAtOnceWithoutAllocating) {
  const AnyBrdf f = brdf("plastic:alpha=0.3");
  for (const bool restart : {false, true}) {
    PaperOptions options = options_of({PaperMap::disk, PaperChoice::cdf, restart});
    options.thetas = 30;
    const PaperSampler sampler(f, {}, options);
    const Direction wo = direction_from_angles(0.8f, 1.f);
    std::vector<DirectionSample<Spectrum>> out(1000);
    Pcg32 rest(5);
    UniformBits u(rest);
    const std::size_t before = allocations();
    double sum = 0, x = 0, y = 0;
    std::size_t filled = 0;
    for (int round = 0; round < 20; ++round) {
      const std::size_t n = sampler.sample_n(wo, u, out);
      filled += n;
      for (std::size_t i = 0; i < n; ++i) {
        sum += double(Target()(out[i].weight)), y += double(dot(out[i].wi, Direction{-wo.y, wo.x, 0}));
        x += double(dot(out[i].wi, Direction{wo.x, wo.y, 0}));
      }
    }
    EXPECT_EQ(allocations(), before);
    EXPECT_EQ(filled, 20'000U);
    EXPECT_NEAR(sum / 20'000, reference_albedo(target_function(f), wo).value, 2e-3 * sum / 20'000);
    EXPECT_NEAR(y / 20'000, 0, 0.01);       // turned with wo
    EXPECT_GT(std::abs(x / 20'000), 0.03);  // the twin: the lobe seen from the side
    std::vector<PaperTree> trees = sampler.trees();
    for (PaperTree& tree : trees) tree.nodes[0].integral *= 1.01;  // the twin: a wrong normaliser
    const PaperSampler twin(f, {}, trees, false, options);
    UniformBits again{Pcg32(5)};
    double wrong = 0;
    const std::size_t drawn = twin.sample_n(wo, again, out);
    for (std::size_t i = 0; i < drawn; ++i) wrong += double(Target()(out[i].weight));
    EXPECT_GT(std::abs(wrong / 1000 - sum / 20'000), 5e-3 * sum / 20'000);
    (void)build_paper_tree(f, {}, wo);
    EXPECT_GT(allocations(), before);  // the twin: the counter counts
  }
}

// Stratified points that enter by the first two words make the mean of a smooth function better.
TEST(PaperSampler, WarpKeepsStratifiedPoints) {
  const AnyBrdf f = brdf("oren_nayar:sigma=0.5");
  PaperOptions options = options_of({PaperMap::disk, PaperChoice::warp, false});
  options.n_max = 1.5;
  const Direction wo = at(45);
  const PaperSampler sampler(f, {}, wo, options);
  double variance[2] = {};
  constexpr int side = 16, rounds = 200;
  for (const bool stratified : {false, true}) {
    Pcg32 random(3);
    double sum = 0, sum2 = 0;
    for (int r = 0; r < rounds; ++r) {
      double mean = 0;
      for (std::uint32_t i = 0; i < side; ++i) {
        for (std::uint32_t j = 0; j < side; ++j) {
          const std::uint32_t x = random(), y = random();
          UniformBits u = stratified ? UniformBits({(i << 28U) | (x >> 4U), (j << 28U) | (y >> 4U)}, random)
                                     : UniformBits({x, y}, random);
          const auto drawn = sampler.sample(wo, u);
          random = u.rest();
          if (drawn) mean += double(drawn->wi.x) / (side * side);
        }
      }
      sum += mean / rounds, sum2 += mean * mean / rounds;
    }
    variance[stratified] = sum2 - sum * sum;
  }
  EXPECT_LT(variance[1], 0.4 * variance[0]);
}

}  // namespace
}  // namespace reflectree
