// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/consistency.hpp"

#include <gtest/gtest.h>

#include "reflectree/verify/faults.hpp"
#include "simple_samplers.hpp"

namespace reflectree {
namespace {

const LowSmoothSampler smooth{low_smooth(300)};
const LowSmoothSampler needle{low_smooth(1e6f)};
const CosineSampler<LowSmooth> loose{low_smooth(5)};

bool fails(const std::vector<CheckResult>& results, const std::string& name) {
  for (const auto& r : results) {
    if (r.name == name) return !r.passed;
  }
  ADD_FAILURE() << "no check named " << name;
  return false;
}

TEST(Consistency, RightSamplersPassAtEveryAngle) {
  for (const double theta : {0., 45., 80., 89., 89.9, 89.999}) {
    const Direction wo = direction_at(theta, 15);
    const auto pass = [&](const ErasedSampler& sampler, const TargetFunction& f) {
      const auto results = check_consistency(sampler, f, wo);
      EXPECT_EQ(results.size(), 6u);
      for (const auto& r : results) EXPECT_TRUE(r.passed) << theta << ' ' << to_line(r);
    };
    pass(erase(smooth), target_function(smooth.f));
    pass(erase(needle), target_function(needle.f));
    pass(erase(loose), target_function(loose.f));
  }
}

TEST(ConsistencyTwin, EveryFaultFailsItsOwnCheck) {
  const TargetFunction f = target_function(smooth.f);
  const Direction wo = direction_at(50);
  const ErasedSampler right = erase(smooth);

  const auto scaled = check_consistency(scaled_pdf(right, 1.01f), f, wo);
  EXPECT_TRUE(fails(scaled, "pdf_integral"));
  EXPECT_TRUE(fails(scaled, "weight_agrees"));
  EXPECT_FALSE(fails(scaled, "pdf_agrees")) << "both are scaled alike";

  EXPECT_TRUE(fails(check_consistency(swapped_pdf(right), f, wo), "pdf_agrees"));
  EXPECT_TRUE(fails(check_consistency(scaled_weight(right, 1.001f), f, wo), "weight_agrees"));

  const auto mortal = check_consistency(dying(right, 1000), f, wo);
  EXPECT_TRUE(fails(mortal, "alive"));

  ErasedSampler blind = right;
  blind.pdf = [inner = right.pdf](Direction o, Direction i) { return i.y > 0.9f ? 0.f : inner(o, i); };
  EXPECT_TRUE(fails(check_consistency(blind, f, wo), "support"));

  ErasedSampler broken = right;
  broken.sample = [inner = right.sample](Direction o, Pcg32& u, DrawnDirection& out) {
    const bool drawn = inner(o, u, out);
    if (u() % 4096 == 0) out.weight = NAN;
    return drawn;
  };
  EXPECT_TRUE(fails(check_consistency(broken, f, wo), "finite"));

  ErasedSampler upside_down = right;
  upside_down.sample = [inner = right.sample](Direction o, Pcg32& u, DrawnDirection& out) {
    const bool drawn = inner(o, u, out);
    if (u() % 4096 == 0) out.wi.z = -out.wi.z;
    return drawn;
  };
  EXPECT_TRUE(fails(check_consistency(upside_down, f, wo), "alive"));
}

// A sampler may lose directions if its pdf says so: then the integral and the losses sum to one.
TEST(Consistency, LossesCountInTheIntegral) {
  const TargetFunction f = target_function(smooth.f);
  const Direction wo = direction_at(50);
  ErasedSampler lossy = dying(erase(smooth), 4);
  ConsistencyOptions options;
  options.max_none = 0.3;
  EXPECT_TRUE(fails(check_consistency(lossy, f, wo, options), "pdf_integral"));
  lossy = scaled_weight(scaled_pdf(lossy, 0.75f), 1 / 0.75f);
  for (const auto& r : check_consistency(lossy, f, wo, options)) EXPECT_TRUE(r.passed) << to_line(r);
}

TEST(Consistency, WithoutADensityTheRestIsChecked) {
  ErasedSampler s = erase(smooth);
  s.pdf = nullptr;
  const auto results = check_consistency(s, target_function(smooth.f), direction_at(30));
  EXPECT_EQ(results.size(), 3u);
  EXPECT_TRUE(all_passed(results));
  EXPECT_FALSE(
      all_passed(check_consistency(scaled_weight(s, 1.001f), target_function(smooth.f), direction_at(30))));

  ErasedSampler unknown = s;
  unknown.sample = [s](Direction wo, Pcg32& u, DrawnDirection& out) {
    const bool drawn = s.sample(wo, u, out);
    out.pdf = 0;
    return drawn;
  };
  EXPECT_TRUE(all_passed(check_consistency(unknown, target_function(smooth.f), direction_at(30))));
  EXPECT_FALSE(all_passed(check_consistency(dying(unknown, 5), target_function(smooth.f), direction_at(30))));
}

}  // namespace
}  // namespace reflectree
