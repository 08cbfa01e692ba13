// SPDX-License-Identifier: Apache-2.0
// The tabulated competitors: their directions are distributed as their own pdf, which together with the lost
// samples integrates to 1; those without lost support are unbiased.
#include <gtest/gtest.h>

#include <cstdio>

#include "reflectree/peers/registry.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/consistency.hpp"
#include "reflectree/verify/faults.hpp"

namespace reflectree {
namespace {

class Tabulated : public testing::TestWithParam<const char*> {};

TEST_P(Tabulated, IsWhatItClaims) {
  const SamplerInfo& info = *find_sampler(GetParam());
  for (const char* text : {"lambert", "ggx:alpha=0.3", "ggx:alpha=0.1"}) {
    const Material material = parse_material(text);
    const PeerSubject subject{make_brdf(material), material, {}};
    const auto sampler = info.make(subject, {});
    ASSERT_TRUE(sampler.has_value());
    const ErasedSampler erased = erase(*sampler);
    const TargetFunction f = target_function(subject.f);
    for (const float theta_o : {0.6f, 1.3f}) {
      const Direction wo = direction_from_angles(theta_o, 0.4f);
      const Bins bins = equal_mass_bins(f, wo, {.count = 100});
      const ChiSquareOptions options{.samples = 200'000, .tests = 60};
      const Tally tally = tally_of(erased, bins, options);
      std::printf("%s %s %.1f: relVar %.4f, lost %.4f, %zu KiB\n", GetParam(), text, double(theta_o),
                  relative_variance(tally), double(tally.none) / double(tally.samples),
                  sampler->bytes() / 1024);
      const auto weights = check_weights(tally, bins, options),
                 mean = check_mean_weight(tally, bins, options);
      if (info.unbiased) {
        EXPECT_TRUE(weights.passed) << text << " " << to_line(weights);
        EXPECT_TRUE(mean.passed) << text << " " << to_line(mean);
      } else {
        std::printf("  %s\n  %s\n", to_line(weights).c_str(), to_line(mean).c_str());
      }
      EXPECT_FALSE(check_weights(tally_of(bent(erased, 2, 0.05, wo), bins, options), bins, options).passed)
          << text;
      ConsistencyOptions loose;
      loose.max_none = 1, loose.integral_tolerance = 5e-3;
      for (const CheckResult& result : check_consistency(erased, f, wo, loose)) {
        if (!info.unbiased && result.name == "support") continue;
        EXPECT_TRUE(result.passed) << text << " " << theta_o << " " << to_line(result);
      }
      EXPECT_FALSE(all_passed(check_consistency(scaled_pdf(erased, 1.05f), f, wo, loose)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Tabulated,
                         testing::Values("cdf-table", "alias-table", "adaptive-cdf", "wavelet",
                                         "warp-chain"));

}  // namespace
}  // namespace reflectree
