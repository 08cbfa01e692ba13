// SPDX-License-Identifier: Apache-2.0
// The tabulated competitors: their directions are distributed as their own pdf, which together with the lost
// samples integrates to 1; those without lost support are unbiased.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <map>

#include "reflectree/formats/material_file.hpp"
#include "reflectree/peers/tabulated.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/consistency.hpp"
#include "reflectree/verify/faults.hpp"

namespace reflectree {
namespace {

std::string measured(const char* name) {
  const char* folder = std::getenv("REFLECTREE_DATA");
  return folder && *folder ? std::string(folder) + "/rgl/" + name + "_rgb.bsdf" : "";
}
struct Made {
  PeerSubject subject;
  AnySampler<Spectrum> sampler;
};
// Tables take most of the time: each is made once.
const Made& made(const std::string& name, const std::string& text) {
  static std::map<std::string, Made> all;
  const auto found = all.find(name + " " + text);
  if (found != all.end()) return found->second;
  const Material material = parse_material(text);
  const PeerSubject subject{make_brdf(material), material, {}};
  auto sampler = find_sampler(name)->make(subject, {});
  return all.emplace(name + " " + text, Made{subject, std::move(*sampler)}).first->second;
}
// So are the bins, which do not depend on the sampler.
const Bins& bins_of(const std::string& name, const TargetFunction& f, Direction wo) {
  static std::map<std::string, Bins> all;
  const std::string key = name + " " + std::to_string(wo.z);
  const auto found = all.find(key);
  return found != all.end() ? found->second
                            : all.emplace(key, equal_mass_bins(f, wo, {.count = 36})).first->second;
}

class Tabulated : public testing::TestWithParam<const char*> {};

// Of one wo in the y-z plane, about which everything is symmetric: half of all directions have x > 0.
Direction known(double deg) { return direction_from_angles(float(deg * double(pi) / 180), 0.5f * pi); }

// These methods lose samples; densities that jump are integrated less sharply.
ConsistencyOptions loose() {
  ConsistencyOptions options;
  options.max_none = 1, options.integral_tolerance = 5e-3;
  return options;
}

void judge(const SamplerInfo& info, const AnySampler<Spectrum>& sampler, const PeerSubject& subject,
           Direction wo, const std::string& material) {
  const std::string where = std::string(info.name) + " " + material + " at z " + std::to_string(wo.z);
  const ErasedSampler erased = erase(sampler);
  const TargetFunction f = target_function(subject.f);
  const Bins& bins = bins_of(material, f, wo);
  const ChiSquareOptions options{.samples = 100'000, .tests = 200};
  const Tally tally = tally_of(erased, bins, options);
  std::printf("%s: relVar %.4f, lost %.4f, %zu KiB\n", where.c_str(), relative_variance(tally),
              double(tally.none) / double(tally.samples), sampler.bytes() / 1024);

  // The directions are as the pdf says. Twin: one side gets 5 % more, the other 5 % less.
  const auto density = density_masses(erased, bins, 3e-3);
  const auto counts = check_counts(tally, density, options);
  EXPECT_TRUE(counts.passed) << where << " " << to_line(counts);
  const Tally twin = tally_of(bent(erased, 0, 0.05), bins, options);
  EXPECT_FALSE(check_counts(twin, density, options).passed) << where;

  // The weights are as the function says.
  const auto weights = check_weights(tally, bins, options), mean = check_mean_weight(tally, bins, options);
  if (info.unbiased) {
    EXPECT_TRUE(weights.passed) << where << " " << to_line(weights);
    EXPECT_TRUE(mean.passed) << where << " " << to_line(mean);
  } else {
    std::printf("  %s\n  %s\n", to_line(weights).c_str(), to_line(mean).c_str());
  }
  EXPECT_FALSE(check_weights(twin, bins, options).passed) << where;

  // Twin: a pdf 5 % too large.
  for (const CheckResult& result : check_consistency(erased, f, bins, density, loose())) {
    if (!info.unbiased && result.name == "support") continue;
    EXPECT_TRUE(result.passed) << where << " " << to_line(result);
  }
  std::vector<double> larger = density;
  for (double& mass : larger) mass *= 1.05;
  EXPECT_FALSE(all_passed(check_consistency(scaled_pdf(erased, 1.05f), f, bins, larger, loose()))) << where;
}

TEST_P(Tabulated, IsWhatItClaims) {
  const SamplerInfo& info = *find_sampler(GetParam());
  for (const char* text : {"lambert", "ggx:alpha=0.3", "ggx:alpha=0.1", "plastic:alpha=0.1"}) {
    const auto& [subject, sampler] = made(GetParam(), text);
    for (const double deg : {35, 75}) judge(info, sampler, subject, known(deg), text);
  }
}

// At an azimuth of wo between two of the tables.
TEST_P(Tabulated, IsWhatItClaimsOnAnisotropicMaterials) {
  const SamplerInfo& info = *find_sampler(GetParam());
  const char* text = "ggx:alpha_x=0.15,alpha_y=0.4,phi_deg=25";
  const auto& [subject, sampler] = made(GetParam(), text);
  for (const float theta : {0.6f, 1.3f})
    judge(info, sampler, subject, direction_from_angles(theta, 1.8f), text);
}

// The twin has tables at one azimuth alone.
TEST_P(Tabulated, KnowsTheAzimuth) {
  const Material material = parse_material("ggx:alpha_x=0.1,alpha_y=0.5");
  const PeerSubject subject{make_brdf(material), material, {}};
  constexpr std::pair<std::string_view, MakeTabulated*> makers[] = {
      {"cdf-table", make_cdf_table}, {"alias-table", make_alias_table},
      {"factored", make_factored},   {"adaptive-cdf", make_adaptive_cdf},
      {"wavelet", make_wavelet},     {"warp-chain", make_warp_chain}};
  const auto* maker =
      std::find_if(std::begin(makers), std::end(makers), [](const auto& m) { return m.first == GetParam(); });
  ASSERT_NE(maker, std::end(makers));
  double variance[2];
  for (const int azimuths : {16, 1}) {
    TabulatedTuning tuning;
    tuning.azimuths = tuning.factored.azimuths = azimuths;
    tuning.slices = tuning.warp.slices = 12;
    const auto sampler = maker->second(subject, {}, tuning);
    ASSERT_TRUE(sampler.has_value());
    double sum = 0, sum2 = 0;
    Pcg32 u(2);
    constexpr int samples = 100'000;
    for (int i = 0; i < samples; ++i) {
      const auto drawn = sampler->sample(direction_from_angles(0.7f, 1.4f), u);
      const double w = drawn ? double(Target{}(drawn->weight)) : 0.;
      sum += w, sum2 += w * w;
    }
    variance[azimuths == 1] = sum2 * samples / (sum * sum) - 1;
  }
  std::printf("%s: relVar %.3f, with one azimuth %.3f\n", GetParam(), variance[0], variance[1]);
  EXPECT_LT(variance[0], 0.7 * variance[1]);
}

TEST_P(Tabulated, IsWhatItClaimsOnMeasuredMaterials) {
  if (measured("").empty()) GTEST_SKIP() << "REFLECTREE_DATA is not set";
  const SamplerInfo& info = *find_sampler(GetParam());
  for (const char* name : {"cardboard", "satin_purple", "chm_mint"}) {
    const PeerSubject subject{load_brdf(measured(name)), {}, {}};
    const auto sampler = info.make(subject, {});
    ASSERT_TRUE(sampler.has_value());
    judge(info, *sampler, subject, known(45), name);
  }
}

// The share of the albedo where the sampler's density is zero, by a density that has no such places.
double lost_mass(const AnySampler<Spectrum>& sampler, const PeerSubject& subject, Direction wo) {
  const auto full = find_sampler("cosine")->make(subject, {});
  Pcg32 u(1);
  double all = 0, lost = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto drawn = full->sample(wo, u);
    if (!drawn) continue;
    const double w = double(subject.target(drawn->weight));
    all += w;
    if (!(sampler.pdf(wo, drawn->wi) > 0)) lost += w;
  }
  return lost / all;
}

// A pure mirror lobe is the hardest: most of the hemisphere is dark, and nothing returns to wo from below.
// Those that are biased are the twin of those that are not.
TEST_P(Tabulated, LosesSupportIfSaidToBeBiased) {
  const SamplerInfo& info = *find_sampler(GetParam());
  double worst = 0;
  for (const char* text : {"phong:kd=0", "ggx:alpha=0.1"}) {
    const auto& [subject, sampler] = made(GetParam(), text);
    for (const double deg : {20, 45, 60, 80}) {
      worst = std::max(worst, lost_mass(sampler, subject, known(deg)));
    }
  }
  std::printf("%s: lost mass %.2g\n", GetParam(), worst);
  // What float holds of a lobe's tail, cos^50 of nearly a right angle, is not what a table can lose.
  EXPECT_EQ(worst < 1e-9, info.unbiased);
}

INSTANTIATE_TEST_SUITE_P(All, Tabulated,
                         testing::Values("cdf-table", "alias-table", "factored", "adaptive-cdf", "wavelet",
                                         "warp-chain"));

double deviation_of(const AnySampler<Spectrum>& sampler, const PeerSubject& subject, Direction wo) {
  Pcg32 u(1);
  double sum = 0, sum2 = 0;
  constexpr int samples = 60'000;
  for (int i = 0; i < samples; ++i) {
    const auto drawn = sampler.sample(wo, u);
    const double w = drawn ? double(subject.target(drawn->weight)) : 0;
    sum += w, sum2 += w * w;
  }
  return std::sqrt(samples * sum2 / (sum * sum) - 1);
}

// The method's own sampling tables give 0.03 to 0.31 standard deviation over mean on its files; fitted from
// the function alone it stays within that, but for the file whose function changes most between 75 and 85
// degrees: there even 48 elevations leave 0.5. A fitted cos^n lobe is the twin that does not.
TEST(WarpChain, IsAsGoodAsPublishedOnItsOwnFiles) {
  if (measured("").empty()) GTEST_SKIP() << "REFLECTREE_DATA is not set";
  for (const char* name : {"cardboard", "satin_purple", "chm_mint"}) {
    const PeerSubject subject{load_brdf(measured(name)), {}, {}};
    const auto sampler = find_sampler("warp-chain")->make(subject, {});
    const auto twin = find_sampler("lafortune-willems")->make(subject, {});
    ASSERT_TRUE(sampler.has_value() && twin.has_value());
    double worst_of_twin = 0;
    for (const double deg : {0, 30, 60, 75, 85}) {
      const double deviation = deviation_of(*sampler, subject, known(deg));
      std::printf("warp-chain %s %2.0f deg: %.3f\n", name, deg, deviation);
      const bool hard = name == std::string("chm_mint") && deg > 70;
      EXPECT_LT(deviation, hard ? 0.6 : 0.31) << name << " " << deg;
      worst_of_twin = std::max(worst_of_twin, deviation_of(*twin, subject, known(deg)));
    }
    EXPECT_GT(worst_of_twin, 0.31) << name;
  }
}

}  // namespace
}  // namespace reflectree
