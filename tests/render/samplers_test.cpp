// SPDX-License-Identifier: Apache-2.0
// Every sampler of the registry in a small picture: all show the same light, and those that do not take a
// material say so.
#include <gtest/gtest.h>

#include "../error_words.hpp"
#include "small_scenes.hpp"

namespace reflectree::render {
namespace {

Scene floor_of(const std::string& material, const std::string& sampler) {
  return lit_floor(R"(<bsdf type="reflectree"><string name="material" value=")" + material + R"("/></bsdf>)",
                   sampler);
}

std::string refusal(const std::string& material, const std::string& sampler) {
  return error_words([&] { floor_of(material, sampler); }, "");
}

TEST(Samplers, EveryOneShowsTheSamePicture) {
  const std::string material = "0.3*lambert + 0.7*ggx:alpha=0.3,f0=0.9/0.7/0.4";
  // The cosine lobe is built from nothing.
  const Sight reference = look(floor_of(material, "cosine"), 8, 1024, 1);
  for (const SamplerInfo& info : samplers()) {
    const std::string name(info.name);
    const Sight seen = look(floor_of(material, name), 8, 128, 11);
    // What is biased in its own paper may be off by what that costs here.
    const double slack = info.unbiased ? 0 : .005;
    const Agreement same = agreement(seen, reference, 1, slack),
                    biased = agreement(seen, reference, 1.02, slack);
    std::printf(
        "%-18s mean %.4f +- %.4f of the reference's, rms of z %.3f (biased by 2 %%: z %.1f, rms %.3f)\n",
        name.c_str(), seen.mean / reference.mean,
        std::hypot(seen.error / seen.mean, reference.error / reference.mean), same.rms, biased.mean,
        biased.rms);
    EXPECT_TRUE(same(1.2)) << name;
    EXPECT_FALSE(biased(1.2)) << name << ": a planted bias of 2 %";
  }
}

TEST(Samplers, ThoseThatDoNotTakeAMaterialSaySo) {
  const std::string retro = "retro_reflector:alpha=0.4";
  for (const SamplerInfo& info : samplers()) {
    const std::string said = refusal(retro, std::string(info.name));
    if (said.empty()) continue;
    EXPECT_FALSE(info.general) << info.name << ": " << said;
    EXPECT_NE(said.find("'" + std::string(info.name) + "'"), std::string::npos) << said;
    EXPECT_NE(said.find("--sampler"), std::string::npos) << said;
  }
  EXPECT_NE(refusal(retro, "textbook"), "") << "no textbook has a sampler for it";
  EXPECT_EQ(refusal("ward:alpha_x=0.1,alpha_y=0.3", "paper"), "");  // its trees stand at azimuths, too
  const std::string unknown = refusal(retro, "clairvoyant");
  for (const SamplerInfo& info : samplers())
    EXPECT_NE(unknown.find(info.name), std::string::npos) << "the choice is named: " << unknown;
}

}  // namespace
}  // namespace reflectree::render
