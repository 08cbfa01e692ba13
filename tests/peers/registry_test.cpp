// SPDX-License-Identifier: Apache-2.0
// The list of samplers, and the handles that it hands out.
#include "reflectree/peers/registry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "reflectree/math/uniform_bits.hpp"
#include "reflectree/verify/reference.hpp"

namespace reflectree {
namespace {

TEST(Registry, NamesAreUniqueAndFound) {
  std::set<std::string_view> names;
  for (const SamplerInfo& info : samplers()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_EQ(find_sampler(info.name), &info);
    EXPECT_FALSE(info.summary.empty() || info.source.empty()) << info.name;
  }
  EXPECT_EQ(find_sampler("no such sampler"), nullptr);
}

// Whatever is listed draws directions above the surface from the density that it states, and weights them
// without bias where it says so: a mean of weights within five standard errors of the albedo.
class EachSampler : public testing::TestWithParam<const SamplerInfo*> {};

void judge(const SamplerInfo& info, const char* text, int may_differ) {
  const Material material = parse_material(text);
  const PeerSubject subject{make_brdf(material), material, {}};
  const auto sampler = info.make(subject, {});
  if (!sampler) {
    EXPECT_FALSE(info.general) << "a general sampler takes any BRDF";
    return;
  }
  const Direction wo = direction_from_angles(0.7f, 0.3f);
  const TargetFunction f = target_function(subject.f);
  const double albedo = reference_albedo(f, wo).value;
  constexpr int draws = 40'000;
  double sum = 0, squares = 0;
  int differ = 0;
  Pcg32 u(5);
  for (int i = 0; i < draws; ++i) {
    const auto s = sampler->sample(wo, u);
    if (!s) continue;  // weight 0
    ASSERT_GT(s->wi.z, 0);
    ASSERT_NEAR(double(length(s->wi)), 1, 1e-4);
    if (sampler->has_pdf()) {
      differ += !(std::abs(sampler->pdf(wo, s->wi) - s->pdf) <= 2e-3f * s->pdf);
    }
    const double weight = double(Target{}(s->weight));
    sum += weight, squares += weight * weight;
  }
  // At the pole of a chart a direction in float no longer tells its place; hardly any is drawn there.
  EXPECT_LE(differ, may_differ);
  const double mean = sum / draws, error = std::sqrt(std::max(squares / draws - mean * mean, 0.) / draws);
  if (info.unbiased) {
    EXPECT_NEAR(mean, albedo, 5 * error + 1e-3 * albedo);
  } else {
    EXPECT_NEAR(mean, albedo, 0.1 * albedo) << "biased, but no stranger";
  }
}

TEST_P(EachSampler, IsWhatItsRowSays) { judge(*GetParam(), "plastic:kd=0.5,alpha=0.4", 0); }

// Those with tables are held to an anisotropic material by tabulated_test, our one-shot modes by
// sampler_anisotropic.
class EachOther : public EachSampler {};
TEST_P(EachOther, TakesAnisotropicFunctions) {
  judge(*GetParam(), "ggx:alpha_x=0.4,alpha_y=0.7,phi_deg=20", 2);
}

std::vector<const SamplerInfo*> all_but(std::initializer_list<std::string_view> names) {
  std::vector<const SamplerInfo*> all;
  for (const SamplerInfo& info : samplers())
    if (std::find(names.begin(), names.end(), info.name) == names.end()) all.push_back(&info);
  return all;
}
const auto name_of_row = [](const auto& row) {
  std::string name(row.param->name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
};
INSTANTIATE_TEST_SUITE_P(Rows, EachSampler, testing::ValuesIn(all_but({})), name_of_row);
INSTANTIATE_TEST_SUITE_P(Rows, EachOther,
                         testing::ValuesIn(all_but({"one-shot", "one-shot-monotone", "cdf-table",
                                                    "alias-table", "factored", "adaptive-cdf", "wavelet",
                                                    "warp-chain"})),
                         name_of_row);

TEST(UniformBits, TheChosenPointComesFirst) {
  Pcg32 rest(7);
  UniformBits bits({11, 12}, rest);
  EXPECT_EQ(bits(), 11U);
  EXPECT_EQ(bits(), 12U);
  EXPECT_EQ(bits(), rest());
  EXPECT_EQ(bits.rest()(), rest());
}

// The generator goes on where the sampler stopped, and the same bits give the same direction.
TEST(AnySampler, PassesRandomBitsOnAndReturnsThem) {
  const Material material = parse_material("ggx:alpha=0.3");
  const PeerSubject subject{make_brdf(material), material, {}};
  const auto sampler = find_sampler("exact")->make(subject, {});
  ASSERT_TRUE(sampler.has_value());
  EXPECT_GT(sampler->bytes(), 0U);
  ASSERT_TRUE(sampler->has_pdf());
  const Direction wo = direction_from_angles(0.7f, 0.3f);
  Pcg32 a(5);
  UniformBits b(a);
  for (int i = 0; i < 100; ++i) {
    const auto x = sampler->sample(wo, a);
    const auto y = sampler->sample(wo, b);
    ASSERT_TRUE(x && y);
    EXPECT_EQ(x->wi.x, y->wi.x);
    EXPECT_NEAR(sampler->pdf(wo, x->wi), x->pdf, 1e-3f * x->pdf);
  }
}

}  // namespace
}  // namespace reflectree
