// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/material/mixture.hpp"

#include <gtest/gtest.h>

#include "random_models.hpp"
#include "reflectree/error.hpp"

namespace reflectree {
namespace {

// A grey and a five-channel function, with knots, for the rules of combination.
struct Grey {
  float operator()(Direction wo, Direction wi) const { return wo.z + wi.z; }
  BrdfTraits traits() const {
    BrdfTraits t;
    t.name = "grey";
    t.concurrent = false;
    t.theta_o_knots = {0.25f, 0.5f};
    return t;
  }
};
struct Five {
  Spectrum operator()(Direction wo, Direction) const {
    Spectrum s(5);
    for (int c = 0; c < 5; ++c) s[c] = wo.z * float(c);
    return s;
  }
  BrdfTraits traits() const {
    BrdfTraits t;
    t.name = "five";
    t.channels = 5;
    t.isotropic = false;
    t.theta_o_knots = {0.5f, 1.f};
    return t;
  }
};

std::vector<Pair> many_pairs() {
  Pcg32 bits(1);
  return test_pairs(400, bits);  // several blocks
}

TEST(Mixture, IsTheSumOfItsTermsInEveryForm) {
  const Lambert a{{0.5f, 0.25f, 1.f}};
  const Ggx b;
  const BrdfSum<Lambert, Ggx> sum{0.25f, a, 0.5f, b};
  const AnyBrdf any = mixture({{0.25f, a}, {0.5f, b}});
  const std::vector<Pair> pairs = many_pairs();
  const Evaluated e = evaluated(any, pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto [wo, wi] = pairs[i];
    const Rgb expected = 0.25f * eval(a, wo, wi) + 0.5f * eval(b, wo, wi);
    EXPECT_EQ(e.of_directions[i], expected);
    EXPECT_EQ(e.of_geometry[i], expected);
    EXPECT_EQ(to_rgb(any(e.geometry[i])), expected);
    EXPECT_EQ(eval(sum, wo, wi), expected);
  }
}

TEST(Mixture, HandsTheGeometryOn) {  // a domain's own half vector must reach the terms
  ShadingGeometry<float> g = shading_geometry(Direction{0.6f, 0, 0.8f}, Direction{-0.6f, 0, 0.8f});
  g.wh = normalize(Direction{0.05f, 0, 1});
  const AnyBrdf any = mixture({{1, Ggx{}}, {1, Lambert{}}});
  EXPECT_EQ(to_rgb(any(g)), Ggx{}(g) + Lambert{}(g));
  EXPECT_NE(to_rgb(any(g)), to_rgb(any(shading_geometry(g.wo, g.wi))));
}

TEST(Mixture, IsZeroBelowTheSurface) {
  const AnyBrdf any = mixture({{1, Lambert{}}, {1, Grey{}}});
  const Direction up{0, 0, 1}, down{0, 0, -1};
  Rgb v{1, 1, 1};
  any.eval({&up, 1}, {&down, 1}, {&v.r, 3});
  EXPECT_EQ(v, Rgb{});
}

// Azimuths of viewers, in bands of elevations.
struct Banded : Grey {
  std::vector<AzimuthKnots> bands;
  bool isotropic = false;
  BrdfTraits traits() const {
    BrdfTraits t = Grey::traits();
    t.phi_o_knots = bands, t.isotropic = isotropic;
    return t;
  }
};
TEST(Mixture, UnitesAzimuthsBandByBand) {
  const Banded a{{}, {{0.5f, {1}}, {pi / 2, {2, 3}}}}, b{{}, {{0.8f, {4}}}};
  const std::vector<AzimuthKnots> sum = mixture({{1, a}, {1, Lambert{}}, {1, b}}).traits().phi_o_knots;
  ASSERT_EQ(sum.size(), 3U);
  EXPECT_EQ(sum[0].theta_o_end, 0.5f);
  EXPECT_EQ(sum[0].phi_o, (std::vector<float>{1, 4}));
  EXPECT_EQ(sum[1].theta_o_end, 0.8f);
  EXPECT_EQ(sum[1].phi_o, (std::vector<float>{2, 3, 4}));
  EXPECT_EQ(sum[2].phi_o, (std::vector<float>{2, 3}));
  Banded same_all_round = a;
  same_all_round.isotropic = true;  // its azimuths are no borders
  EXPECT_TRUE(mixture({{1, same_all_round}, {1, Five{}}}).traits().phi_o_knots.empty());
}

TEST(Mixture, CombinesTraits) {
  const AnyBrdf any = mixture({{0.5f, Grey{}}, {1, Five{}}});
  EXPECT_EQ(any.channels(), 5);
  EXPECT_FALSE(any.traits().isotropic);
  EXPECT_FALSE(any.traits().concurrent);
  EXPECT_EQ(any.traits().theta_o_knots, (std::vector<float>{0.25f, 0.5f, 1.f}));
  EXPECT_EQ(any.traits().name, "0.5*grey + five");
  EXPECT_EQ(mixture({{0.5f, any}}).traits().name, "0.5*(0.5*grey + five)");
  EXPECT_TRUE(mixture({{1, Lambert{}}, {1, Ggx{}}}).traits().isotropic);

  const Direction wo{0, 0, 1}, wi{0.6f, 0, 0.8f};
  const Spectrum value = any(shading_geometry(wo, wi));
  for (int c = 0; c < 5; ++c) EXPECT_FLOAT_EQ(value[c], 0.5f * 1.8f + float(c));
}

struct ToldAlbedo {
  float operator()(Direction, Direction) const { return 0.3f; }
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.channels = 1, traits.albedo = [](Direction) { return 0.3 * pi_v<double>; };
    return traits;
  }
};
TEST(Mixture, ScalesTheAlbedoThatIsTold) {
  const AnyBrdf f = mixture({{0.5f, ToldAlbedo()}});
  EXPECT_NEAR(f.traits().albedo({0, 0, 1}), 0.15 * pi_v<double>, 1e-12);
  EXPECT_FALSE(mixture({{0.5f, ToldAlbedo()}, {0.5f, ToldAlbedo()}}).traits().albedo);
}

TEST(Mixture, RefusesWhatDoesNotFit) {
  EXPECT_THROW(mixture({}), Error);
  EXPECT_THROW(mixture({{1, Five{}}, {1, Lambert{}}}), Error);
  EXPECT_THROW(mixture({{-1, Lambert{}}}), Error);
  EXPECT_THROW(mixture({{std::nanf(""), Lambert{}}}), Error);
}

}  // namespace
}  // namespace reflectree
