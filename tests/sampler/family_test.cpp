// SPDX-License-Identifier: Apache-2.0
// One sampler of every member of a family.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "functions.hpp"
#include "reflectree/brdf/material/model_family.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/sampler/family_sampler.hpp"
#include "reflectree/sampler/member.hpp"
#include "reflectree/simd/sample_batch.hpp"

namespace reflectree {
namespace {

using Metal = ModelFamily<Ggx>;

Family<Metal> metal_family() { return model_family(Ggx{}, {{"alpha", 0.02f, 1}}); }

struct Built {
  SamplerData data;
  FamilySampler<Metal> sampler;
};
const Built& metal() {
  static const Built b = [] {
    SamplerData data = build(AnyFamily(metal_family()));
    return Built{data, make_sampler(metal_family(), data)};
  }();
  return b;
}

// Members and viewers anywhere; every fourth viewer near grazing, the first members at the ends.
struct Look {
  Parameters at{};
  Direction wo;
};
std::vector<Look> looks(std::uint64_t seed, int count) {
  Pcg32 u(seed);
  std::vector<Look> all;
  for (int i = 0; i < count; ++i) {
    const float share = i == 0 ? 0.f : i == 1 ? 1.f : to_unit_float(u());
    const double theta = i % 4 == 3 ? 89 : 88 * to_unit_double(u());
    all.push_back({{0.02f * std::pow(50.f, share)}, wo_at(theta, 6.2831853 * to_unit_double(u()))});
    all.back().at[0] = clamp(all.back().at[0], 0.02f, 1.f);
  }
  return all;
}

::testing::AssertionResult draws_members(const FamilySampler<Metal>& s, std::uint64_t seed, int count) {
  const AnyFamily family(metal_family());
  for (const Look& look : looks(seed, count)) {
    const auto results = judge(s.at(look.at), target_function(family.member(look.at)), look.wo, 200'000);
    if (!all_passed(results)) {
      return ::testing::AssertionFailure()
             << "alpha " << look.at[0] << ", theta_o " << theta_of(look.wo) << '\n'
             << to_text(results);
    }
  }
  return ::testing::AssertionSuccess();
}

TEST(Family, OfMetalKeepsItsPromises) {
  const SamplerData& data = metal().data;
  EXPECT_EQ(data.domain.kind, DomainKind::scaled_star);
  EXPECT_TRUE(data.frame.isotropic());
  EXPECT_GT(data.law.x[1], 0.3f);  // the widths follow alpha by a power
  EXPECT_LE(data.report.expected_trials, 1.25f);
  EXPECT_LE(data.albedo.relative_error, 1.001e-4f);
  EXPECT_TRUE(data.report.notes.empty());
  EXPECT_LE(bytes_of(pack(data)), 256U * 1024);
}

TEST(Family, EveryMemberIsDrawn) { EXPECT_TRUE(draws_members(metal().sampler, 1, 10)); }

TEST(Family, ValuesAreThoseOfTheMember) {
  const Built& b = metal();
  Pcg32 u(3);
  for (const Look& look : looks(5, 40)) {
    const auto s = b.sampler.exact.sample(look.wo, look.at, u);
    ASSERT_TRUE(s);
    const Rgb f = eval(Ggx{look.at[0]}, look.wo, s->wi);
    const float albedo = b.sampler.exact.at(look.at).albedo(look.wo), t = b.data.target(f);
    EXPECT_NEAR(double(s->pdf), double(t * s->wi.z / albedo), 2e-3 * double(s->pdf));
    EXPECT_NEAR(double(s->weight.g), double(f.g * s->wi.z / s->pdf), 2e-3 * double(s->weight.g));
    const auto q = b.sampler.one_shot.sample(look.wo, look.at, 0.3, 0.6);
    ASSERT_TRUE(q);
    EXPECT_NEAR(double(b.sampler.one_shot.pdf(look.wo, q->wi, look.at)), double(q->pdf),
                3e-3 * double(q->pdf));
    const auto place = b.sampler.one_shot.at(look.at).invert(look.wo, q->wi);
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->x, 0.3, 2e-3);
    EXPECT_NEAR(place->y, 0.6, 2e-3);
  }
}

// By a cubature that shares no code with the builder.
TEST(Family, AlbedoBetweenItsRows) {
  const AnyFamily family(metal_family());
  for (const Look& look : looks(21, 12)) {
    const Bins bins = equal_mass_bins(target_function(family.member(look.at)), look.wo);
    EXPECT_NEAR(double(metal().sampler.exact.at(look.at).albedo(look.wo)) / bins.total, 1,
                1e-4 + bins.worst_error)
        << look.at[0] << ' ' << theta_of(look.wo);
  }
}

// Every shape of a table and its packed form: one parameter or two, with and without azimuths, these in two
// segments with both sides of a leap.
TEST(Family, AlbedoOfEveryShape) {
  const std::vector<float> two_segments{0, 0.5f, 1, 1, 2, 3};
  const std::vector<AlbedoAxis> axes{{0, 1, 4}, {-1, 2, 5}};
  Pcg32 u(17);
  for (const bool turned : {false, true}) {
    for (const std::size_t parameters : {1U, 2U}) {
      AlbedoTable table{{min_cos_theta_o, 0.5f, 1}, {}, 1e-4f};
      if (turned) table.phi_o = two_segments;
      table.parameters.assign(axes.begin(), axes.begin() + std::ptrdiff_t(parameters));
      const std::size_t columns = table.cos_theta_o.size(), azimuths = turned ? 6 : 1;
      const std::size_t size = columns * azimuths * 4 * (parameters > 1 ? 5 : 1);
      for (std::size_t k = 0; k < size; ++k) table.albedo.push_back(1 + to_unit_float(u()));
      validate(table);
      const PackedAlbedo packed = pack(table);
      for (std::size_t k = 0; k < table.albedo.size(); ++k) {
        std::size_t rest = k / columns;
        float phi = turned ? table.phi_o[rest % azimuths] : 0;
        if (turned && rest % azimuths == 2) phi = std::nextafter(phi, 0.f);
        rest /= azimuths;
        const Coordinates at{float(rest % 4) / 3, -1 + 0.75f * float(rest / 4)};
        const float c = table.cos_theta_o[k % columns];
        EXPECT_NEAR(albedo_at(table, c, phi, at), table.albedo[k], 2e-5f) << k;
        EXPECT_NEAR(packed.at(c, phi, at), table.albedo[k], 2e-5f) << k;
      }
      for (int i = 0; i < 2000; ++i) {
        const float c = max(to_unit_float(u()), min_cos_theta_o), phi = turned ? 3 * to_unit_float(u()) : 0;
        const Coordinates at{to_unit_float(u()), 3 * to_unit_float(u()) - 1};
        EXPECT_NEAR(packed.at(c, phi, at), albedo_at(table, c, phi, at), 2e-5f) << c << ' ' << phi;
      }
    }
  }
}

// One-shot mode does not look up an albedo that is 0 nowhere: what says so must be right.
TEST(Family, AlbedoThatIsZeroNowhere) {
  Pcg32 u(29);
  int positive = 0, zero = 0;
  for (int k = 0; k < 400; ++k) {
    AlbedoTable table{{min_cos_theta_o, 0.4f, 1}, {}, 1e-4f};
    table.parameters = {{0, 1, 6}};
    // Rows that differ by up to some orders of magnitude: cubics between them swing below 0.
    const float contrast = 0.04f * float(k % 100);
    for (int i = 0; i < 18; ++i) table.albedo.push_back(std::exp(-contrast * to_unit_float(u())));
    const PackedAlbedo packed = pack(table);
    float least = 1;
    for (int i = 0; i < 1000; ++i) {
      const float c = max(to_unit_float(u()), min_cos_theta_o);
      least = min(least, packed.at(c, 0, {to_unit_float(u())}));
    }
    positive += packed.positive;
    zero += least <= 0;
    EXPECT_FALSE(packed.positive && least <= 0) << k;
  }
  EXPECT_GT(positive, 20) << zero;
  EXPECT_GT(zero, 20);
  EXPECT_TRUE(metal().sampler.exact.packed().viewer.albedo.positive);
}

TEST(Family, NoSampleWhereTheAlbedoIsZero) {
  const auto grey =
      family([](Direction, Direction, const Parameters& p) { return p[0] / pi; }, {{"p", 0, 1}});
  BuildOptions rough;
  rough.expected_trials = 2, rough.one_shot_variance = 0.2f, rough.albedo_error = 1e-2f;
  const auto s = make_sampler(grey, rough);
  EXPECT_FALSE(s.exact.packed().viewer.albedo.positive);
  Pcg32 u(1);
  EXPECT_FALSE(s.exact.sample(wo_at(30), {0}, u));
  EXPECT_FALSE(s.one_shot.sample(wo_at(30), {0}, u));
  EXPECT_FALSE(s.one_shot.sample(wo_at(30), {0}, 0.3, 0.3));
  EXPECT_TRUE(s.exact.sample(wo_at(30), {0.5f}, u));
  EXPECT_TRUE(s.one_shot.sample(wo_at(30), {0.5f}, u));
}

TEST(Family, TrialsAndVarianceOfEveryMember) {
  const Built& b = metal();
  Pcg32 u(11);
  for (const Look& look : looks(31, 12)) {
    SampleStatistics statistics;
    for (int i = 0; i < 20'000; ++i) ASSERT_TRUE(b.sampler.exact.sample(look.wo, look.at, u, statistics));
    const double trials = double(statistics.trials) / double(statistics.accepted);
    EXPECT_LT(trials, 1.25 + 4 * 0.56 / std::sqrt(20'000.));  // standard deviation of a count: 0.56
    double sum = 0, square = 0;
    for (int i = 0; i < 20'000; ++i) {
      const auto s = b.sampler.one_shot.sample(look.wo, look.at, u);
      ASSERT_TRUE(s);
      const double w = double(b.data.target(s->weight));
      sum += w, square += w * w;
    }
    EXPECT_LT(square / 20'000 / sqr(sum / 20'000) - 1, 0.02) << look.at[0] << ' ' << theta_of(look.wo);
  }
}

TEST(Family, NoSampleOutsideOfTheRange) {
  const Built& b = metal();
  Pcg32 u(1);
  for (const float alpha : {0.0199f, 1.001f, 0.f, -1.f, NAN, INFINITY}) {
    EXPECT_FALSE(b.sampler.exact.sample(wo_at(30), {alpha}, u)) << alpha;
    EXPECT_FALSE(b.sampler.one_shot.sample(wo_at(30), {alpha}, 0.5, 0.5)) << alpha;
    EXPECT_EQ(b.sampler.exact.pdf(wo_at(30), wo_at(10), {alpha}), 0) << alpha;
    EXPECT_THROW(AnyFamily(metal_family()).member({alpha}), Error) << alpha;
  }
  EXPECT_TRUE(b.sampler.exact.sample(wo_at(30), {0.02f}, u));
  EXPECT_TRUE(b.sampler.exact.sample(wo_at(30), {1}, u));
}

TEST(Family, BatchesOfOneMember) {
  const auto one_shot = metal().sampler.one_shot.at({0.3f});
  std::vector<Direction> wo;
  for (const Look& look : looks(9, 200)) wo.push_back(look.wo);
  std::vector<DirectionSample<Rgb>> out(wo.size());
  Pcg32 one(7), many(7);
  sample_batch(one_shot, wo, many, out);
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const auto s = one_shot.sample(wo[i], one);
    ASSERT_TRUE(s);
    EXPECT_LT(length(s->wi - out[i].wi), 1e-5f) << i;
    EXPECT_NEAR(double(s->pdf), double(out[i].pdf), 1e-3 * double(s->pdf)) << i;
  }
}

TEST(Family, IsRefusedWhereItIsWrong) {
  EXPECT_THROW(AnyFamily(model_family(Ggx{}, {{"alpha", 1, 0.02f}})), Error);
  EXPECT_THROW(AnyFamily(model_family(Ggx{}, {{"alpha", 0.02f, 0.02f}})), Error);
  EXPECT_THROW(model_family(Ggx{}, {{"alpha", 0.02f, 2}}), Error);
  EXPECT_THROW(model_family(Ggx{}, {{"width", 0.02f, 1}}), Error);
  EXPECT_THROW(model_family(Ggx{}, {{"f0", 0.02f, 1}}), Error);
  EXPECT_THROW(AnyFamily(model_family(Ggx{}, {})), Error);
  // Data of a family is no data of a member, nor of other ranges.
  EXPECT_THROW(make_sampler(Ggx{0.1f}, metal().data), Error);
  EXPECT_THROW(make_sampler(model_family(Ggx{}, {{"alpha", 0.02f, 0.9f}}), metal().data), Error);
  EXPECT_THROW(make_sampler(model_family(Ggx{0.1f, {1, 1, 1}}, {{"alpha", 0.02f, 1}}), metal().data), Error);
  const auto negative =
      family([](Direction, Direction wi, const Parameters& p) { return wi.z - p[0]; }, {{"p", 0.f, 0.5f}});
  EXPECT_THROW(build(AnyFamily(negative)), Error);
}

// Any formula: a matt surface with a lobe of a width and a weight of its own, told of by nothing.
TEST(Family, OfTwoParameters) {
  const auto lobes = family(
      [](Direction wo, Direction wi, const Parameters& p) {
        const Direction h = normalize(wo + wi);
        const float tan2 = (1 - h.z * h.z) / (h.z * h.z);
        return 0.1f + p[1] * std::exp(-tan2 / sqr(p[0])) / sqr(p[0]);
      },
      {{"width", 0.2f, 0.8f}, {"weight", 0, 0.3f}});
  BuildOptions options;
  options.expected_trials = 2, options.one_shot_variance = 0.2f, options.albedo_error = 1e-3f;
  const SamplerData data = build(AnyFamily(lobes), options);
  EXPECT_EQ(data.exact_partition.coordinates.size(), 3U);
  const auto s = make_sampler(lobes, data);
  Pcg32 u(2);
  for (int i = 0; i < 6; ++i) {
    const Parameters at{0.2f + 0.6f * to_unit_float(u()), 0.3f * to_unit_float(u())};
    const Direction wo = wo_at(88 * to_unit_double(u()), 2);
    const auto results = judge(s.at(at), target_function(AnyFamily(lobes).member(at)), wo, 200'000);
    EXPECT_TRUE(all_passed(results)) << at[0] << ' ' << at[1] << '\n' << to_text(results);
  }
}

// A member cut out draws the same directions.
TEST(Family, MembersAreSamplersOfTheirOwn) {
  const Built& b = metal();
  for (const float alpha : {0.02f, 0.11f, 0.5f, 1.f}) {
    const AnyBrdf f = Ggx{alpha};
    const SamplerData data = member_data(b.data, {alpha}, f.traits().name, probe_identity(f, b.data.target));
    EXPECT_LT(data.exact.size(), b.data.exact.size() / 4);
    EXPECT_LE(data.report.expected_trials, 1.25f);
    const auto one = make_sampler(f, data);
    Pcg32 u(1), v(1);
    for (const Look& look : looks(61, 100)) {
      const auto s = one.exact.sample(look.wo, u);
      const auto t = b.sampler.exact.sample(look.wo, {alpha}, v);
      ASSERT_TRUE(s && t);
      EXPECT_LT(length(s->wi - t->wi), 1e-4f);
      EXPECT_NEAR(double(s->pdf), double(t->pdf), 1e-2 * double(s->pdf));
    }
  }
}

// Planted faults: rejection hides those that only bend a tree; the bounds tell.
double overshoot_of(const FamilySampler<Metal>& s) {
  SampleStatistics statistics;
  Pcg32 u(17);
  for (const Look& look : looks(41, 1000)) {
    for (int i = 0; i < 100; ++i) s.exact.sample(look.wo, look.at, u, statistics);
  }
  return statistics.overshoot_sum / double(statistics.trials);
}
TEST(Family, BoundsHold) { EXPECT_LT(overshoot_of(metal().sampler), 1e-6); }
bool is_seen(const SamplerData& data) {
  const FamilySampler<Metal> s = make_sampler(metal_family(), data);
  return overshoot_of(s) > 1e-5 || !draws_members(s, 31, 6);
}
TEST(FamilyTwin, ASlabWithItsNeighboursTree) {
  SamplerData data = metal().data;
  std::rotate(data.exact.begin(), data.exact.begin() + 1, data.exact.end());
  EXPECT_TRUE(is_seen(data));
}
TEST(FamilyTwin, WidthsThatAreNotTheTrees) {
  SamplerData data = metal().data;
  data.law.x[1] *= 0.9f, data.law.y[1] *= 0.9f;
  EXPECT_TRUE(is_seen(data));
}
TEST(FamilyTwin, AlbedoOfAnotherMember) {
  SamplerData data = metal().data;
  const std::size_t columns = data.albedo.cos_theta_o.size();
  std::rotate(data.albedo.albedo.begin(), data.albedo.albedo.begin() + std::ptrdiff_t(columns),
              data.albedo.albedo.end());
  EXPECT_TRUE(is_seen(data));
}
TEST(FamilyTwin, AMemberTwoPercentOff) {
  const AnyFamily family(metal_family());
  bool seen = false;
  for (const Look& look : looks(51, 4)) {
    const float other = clamp(look.at[0] * 1.02f, 0.02f, 0.98f);
    seen = seen || !all_passed(judge(metal().sampler.at(look.at), target_function(family.member({other})),
                                     look.wo, 200'000));
  }
  EXPECT_TRUE(seen);
}

}  // namespace
}  // namespace reflectree
