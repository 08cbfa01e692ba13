// SPDX-License-Identifier: Apache-2.0
// Every sampler of the registry in a small picture: all show the same light, and those that do not take a
// material say so.
#include <gtest/gtest.h>

#include "small_scenes.hpp"

namespace reflectree::render {
namespace {

// A floor of `material` under a lamp, a sun and a sky.
Scene floor_of(const std::string& material, const std::string& sampler) {
  SceneOptions options;
  options.sampler = sampler;
  return parse_scene(
      small_scene(
          "3",
          R"(<shape type="rectangle"><transform name="to_world"><scale value="3"/></transform>
    <bsdf type="reflectree"><string name="material" value=")" +
              material +
              R"("/></bsdf></shape><emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>
    <emitter type="directional"><vector name="direction" x="0.2" y="0.5" z="-1"/><rgb name="irradiance" value="1"/>
    </emitter><shape type="disk"><transform name="to_world"><rotate x="1" angle="120"/><translate y="2" z="1.5"/>
    </transform><emitter type="area"><rgb name="radiance" value="2"/></emitter></shape>)",
          "0,-4,1.4"),
      "floor.xml", options);
}

std::string refusal(const std::string& material, const std::string& sampler) {
  try {
    floor_of(material, sampler);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
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
