// SPDX-License-Identifier: Apache-2.0
// A roughness that varies over a floor, by the sampler of its family: what two materials show in turn.
#include <gtest/gtest.h>

#include "../error_words.hpp"
#include "reflectree/render/materials/scattering_family.hpp"
#include "small_scenes.hpp"

namespace reflectree::render {
namespace {

std::string squares(const std::string& name, const std::string& a, const std::string& b) {
  return R"(<texture name=")" + name + R"(" type="checkerboard"><rgb name="color0" value=")" + a +
         R"("/><rgb name="color1" value=")" + b +
         R"("/><transform name="to_uv"><scale x="3" y="3"/></transform></texture>)";
}

std::string plain(const std::string& material) {
  return R"(<bsdf type="reflectree"><string name="material" value=")" + material + R"("/></bsdf>)";
}

std::string varied(const std::string& family, const std::string& values) {
  return R"(<bsdf type="reflectree"><string name="material" value=")" + family + R"("/>)" + values +
         "</bsdf>";
}

TEST(Varied, SquaresOfTwoRoughnessesAreWhatTwoMaterialsShow) {
  const std::string family = "ggx:alpha=0.25..0.75,f0=0.9/0.7/0.4", weight = squares("weight", "0", "1");
  const Sight reference =
      look(lit_floor("<bsdf type=\"blendbsdf\">" + weight + plain("ggx:alpha=0.25,f0=0.9/0.7/0.4") +
                         plain("ggx:alpha=0.75,f0=0.9/0.7/0.4") + "</bsdf>",
                     "cosine"),
           8, 512, 1);
  for (const std::string sampler : {"exact", "one-shot"}) {
    const Sight seen = look(lit_floor(varied(family, squares("alpha", "0.25", "0.75")), sampler), 8, 128, 11);
    const Agreement same = agreement(seen, reference);
    EXPECT_TRUE(same(1.15)) << sampler << ": rms " << same.rms << ", z " << same.mean;
    EXPECT_FALSE(agreement(seen, reference, 1.02)(1.15)) << sampler;
  }
  const Sight other =
      look(lit_floor(varied(family, squares("alpha", "0.3", "0.75")), "one-shot"), 8, 128, 11);
  EXPECT_FALSE(agreement(other, reference)(1.15)) << "0.3 in place of 0.25 is seen";
}

TEST(Varied, ANumberIsAMember) {
  const Scene member =
      lit_floor(varied("ggx:alpha=0.25..0.75", R"(<float name="alpha" value="0.5"/>)"), "one-shot");
  const Agreement same =
      agreement(look(member, 8, 128, 3), look(lit_floor(plain("ggx:alpha=0.5"), "cosine"), 8, 256, 5));
  EXPECT_TRUE(same(1.15)) << "rms " << same.rms << ", z " << same.mean;
}

std::string refusal(const std::string& bsdf, const std::string& sampler = "one-shot") {
  return error_words([&] { lit_floor(bsdf, sampler); }, "");
}

TEST(Varied, WhatIsOutsideOfTheRangeIsRefused) {
  const std::string family = "ggx:alpha=0.25..0.75";
  EXPECT_NE(refusal(varied(family, squares("alpha", "0.2", "0.5"))).find("alpha is 0.2 to 0.5"),
            std::string::npos);
  EXPECT_NE(refusal(varied(family, R"(<float name="alpha" value="0.8"/>)")).find("wider range"),
            std::string::npos);
  EXPECT_NE(refusal(varied(family, "")).find("has a range, and no value"), std::string::npos);
  EXPECT_NE(refusal(varied(family, R"(<float name="alpha" value="0.5"/><float name="beta" value="0.5"/>)"))
                .find("beta"),
            std::string::npos);
  EXPECT_NE(refusal(varied("ggx:alpha=0.3", R"(<float name="alpha" value="0.3"/>)")).find("not known"),
            std::string::npos);
  EXPECT_NE(refusal(varied(family, R"(<float name="alpha" value="0.5"/>)"), "cosine").find("--sampler exact"),
            std::string::npos);
}

TEST(Varied, ATexelThatIsNoNumberIsRefused) {
  const AnyFamily any(
      family([](Direction, Direction, const Parameters& p) { return p[0]; }, {{"rho", 0.1f, 0.3f}}));
  BuildOptions quick;
  quick.expected_trials = 2, quick.one_shot_variance = 0.2f, quick.albedo_error = 1e-2f;
  const auto sampler = make_sampler(Family<AnyFamily>{any, any.ranges(), "grey"}, quick);
  Texture texture;
  const auto with = [&](float texel) {
    Image image = make_image(2, 1, {"Y"});
    image.values = {0.2f, texel};
    texture.picture = std::make_shared<const Image>(std::move(image));
    sampled_family(sampler, true, {texture});
  };
  EXPECT_NO_THROW(with(0.3f));
  EXPECT_THROW(with(std::nanf("")), Error);
  EXPECT_THROW(with(0.31f), Error);
}

}  // namespace
}  // namespace reflectree::render
