// SPDX-License-Identifier: Apache-2.0
// Exact mode's rejection, watched; the verdict about overshoots says what trials can tell.
#include "reflectree/verify/trials.hpp"

#include "reflectree/verify/faults.hpp"
#include "reflectree/verify/ways.hpp"
#include "simple_samplers.hpp"
#include "suspects.hpp"

namespace reflectree {
namespace {

ChiSquareOptions options() {
  ChiSquareOptions o;
  o.tests = 100;
  return o;
}

TEST(Trials, AcceptAndGiveUpAsPromised) {
  const Suspect s = built().suspect();
  int watched = 0;
  for (const WayIn& way : s.ways) {
    if (!way.watch) continue;
    ++watched;
    const TrialLog log = watch_trials(s, way, 200'000, 1);
    const CheckResult accepted = check_acceptance(way.name, log, options()), end = check_giving_up(way);
    EXPECT_TRUE(accepted.passed) << to_line(accepted);
    EXPECT_TRUE(end.passed && end.decided) << to_line(end);
  }
  EXPECT_EQ(watched, 3);
}

TEST(TrialsTwin, ALaneThatAlwaysAccepts) {
  const Suspect s = built().suspect();
  WayIn way = s.ways[2];
  ASSERT_EQ(way.name, "exact, batch");
  TrialLog log = watch_trials(s, way, 200'000, 1);
  log.lane[63].accepted = log.lane[63].trials;
  EXPECT_FALSE(check_acceptance(way.name, log, options()).passed);
}

TEST(TrialsTwin, NeighboursThatShareTheirUniform) {
  const Suspect s = built().suspect();
  TrialLog log;
  Pcg32 u(7);
  for (int call = 0; call < 4000; ++call) {
    detail::LaneWatcher watcher(log, true);
    std::uint32_t shared = 0;
    for (std::size_t k = 0; k < batch_lanes; ++k) {
      if (k % 2 == 0) shared = u();
      watcher.trial(to_unit_double(shared) < 0.8, 0.8f, 1);
    }
  }
  const CheckResult dependent = check_acceptance("batch", log, options());
  EXPECT_FALSE(dependent.passed) << to_line(dependent);
  EXPECT_NE(dependent.detail.find("depends"), std::string::npos) << dependent.detail;
}

TEST(TrialsTwin, GivingUpEarly) {
  WayIn way = built().suspect().ways[0];
  way.give_up = [](Direction) { return std::uint64_t(8); };
  EXPECT_FALSE(check_giving_up(way).passed);
  way.give_up = [](Direction) { return std::uint64_t(0); };
  EXPECT_TRUE(check_giving_up(way).passed);
  EXPECT_FALSE(check_giving_up(way).decided);
}

TEST(Overshoot, TheVerdictSaysWhatTrialsCanTell) {
  const auto mass = [](std::uint64_t overshoots, double each, std::uint64_t trials) {
    OvershootSums sums;
    for (std::uint64_t i = 0; i < overshoots; ++i) sums.add(1 + each);
    sums.trials = trials;
    sums.ratio = 0.8 * double(trials);
    return overshoot_mass(sums, 1.01 + each);
  };
  const CheckResult none = check_overshoot(mass(0, 0, 10'000'000));
  EXPECT_TRUE(none.passed && none.decided) << to_line(none);
  // Some large excesses, 7.5e-7 in the mean: the upper bound is above 1e-6, the mass may well be below.
  const CheckResult open = check_overshoot(mass(60, 0.1, 10'000'000));
  EXPECT_TRUE(open.passed) << to_line(open);
  EXPECT_FALSE(open.decided) << to_line(open);
  EXPECT_NE(open.detail.find("cannot tell"), std::string::npos);
  EXPECT_EQ(to_line(open).substr(0, 4), "open");
  // A hundred times the trials decide it.
  const CheckResult told = check_overshoot(mass(6000, 0.1, 1'000'000'000));
  EXPECT_TRUE(told.passed && told.decided) << to_line(told);
  // Twenty times the limit: surely above.
  const CheckResult above = check_overshoot(mass(16'000, 0.1, 100'000'000));
  EXPECT_FALSE(above.passed) << to_line(above);
}

TEST(OvershootTwin, HalvedBoundsFail) {
  const Sampler<Plastic> sampler = sampler_of(pack(with_halved_bounds(built().data)));
  const Suspect s = suspect_of(sampler);
  const TrialLog log = watch_trials(s, s.ways[0], 300'000, 1);
  EXPECT_FALSE(check_overshoot(overshoot_mass(log.sums)).passed);
}

TEST(Bounds, RatiosAreThoseOfTheTrials) {
  const RatioFunction ratio = bound_ratio(AnyBrdf(coloured()), built().data);
  AttackOptions small;
  small.probes = 1 << 14;
  const double worst = attack(ratio, small).worst;
  EXPECT_GT(worst, 0.9);
  EXPECT_LT(worst, 1.02);
  const SamplerData halved = with_halved_bounds(built().data);
  const AnyBrdf f(coloured());
  EXPECT_GT(attack(bound_ratio(f, halved), small).worst, 1.5);
}

}  // namespace
}  // namespace reflectree
