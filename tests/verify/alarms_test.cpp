// SPDX-License-Identifier: Apache-2.0
// Sound samplers give no alarm, whatever the seed: twenty runs of verify() always, a thousand in the long
// tier.
#include <gtest/gtest.h>

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/brdf/models/plastic.hpp"
#include "reflectree/verify/faults.hpp"
#include "reflectree/verify/verify.hpp"
#include "threads.hpp"

namespace reflectree {
namespace {

// Little of everything, at elevations that only the seed decides.
VerifyOptions little(std::uint64_t seed) {
  VerifyOptions options;
  options.seed = seed;
  options.theta_o_deg = {};
  options.random_elevations = 2;
  options.samples = 40'000;
  options.effort = 0.02;
  options.albedo_directions = 24;
  return options;
}

template <Brdf F>
class Sound {
 public:
  explicit Sound(F f) : data_(build(AnyBrdf(f))), sampler_(make_sampler(f, data_)) {}
  // The lines of checks that failed.
  std::string alarms(std::uint64_t seed) const {
    std::string lines;
    const VerifyReport report = verify(sampler_, &data_, little(seed), two_threads());
    EXPECT_GT(report.checks.size(), 100u);
    for (const CheckResult& check : report.checks) {
      if (!check.passed) lines += check.where + ", " + check.way + ": " + to_line(check) + "\n";
    }
    return lines;
  }

 private:
  SamplerData data_;
  Sampler<F> sampler_;
};

// A lambda is judged through the functions that lambdas take.
float mild(Direction wo, Direction wi) { return 0.1f + 0.2f * wo.z * wi.z * wi.z; }

void run(std::uint64_t first, std::uint64_t seeds) {
  Plastic plastic;
  plastic.kd = {0.5f, 0.2f, 0.1f};
  plastic.alpha = 0.3f;
  const Sound a(plastic);
  // Of known type computed in lanes; the others through the one erased type, which compiles once.
  const Sound b{AnyBrdf(Ggx{0.2f, {1.f, 0.8f, 0.3f}})};
  const Sound c{AnyBrdf(Lambert{})};
  const Sound d{AnyBrdf(mild)};
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    const std::string lines = seed % 4 == 0   ? a.alarms(seed)
                              : seed % 4 == 1 ? b.alarms(seed)
                              : seed % 4 == 2 ? c.alarms(seed)
                                              : d.alarms(seed);
    EXPECT_EQ(lines, "") << "seed " << seed;
  }
}

TEST(FalseAlarms, NoneInTwentyRuns) { run(1, 20); }
TEST(LongFalseAlarms, NoneInAThousandRuns) { run(1000, 1000); }

// So little still sees a fault of five per cent.
TEST(FalseAlarmsTwin, AFaultIsSeenBySoLittle) {
  const Plastic plastic;
  const SamplerData data = build(AnyBrdf(plastic));
  const auto sampler = make_sampler(plastic, data);
  Suspect s = suspect(sampler, AnyBrdf(plastic), &data);
  for (WayIn& way : s.ways) {
    if (way.name == "one-shot, points") way = scaled_weight(std::move(way), 1.05f);
  }
  EXPECT_FALSE(verify(s, little(5), two_threads()).all_passed());
}

}  // namespace
}  // namespace reflectree
