// SPDX-License-Identifier: Apache-2.0
// The list of samplers, and the handles that it hands out.
#include "reflectree/peers/registry.hpp"

#include <gtest/gtest.h>

#include <set>

#include "reflectree/math/uniform_bits.hpp"

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
