// SPDX-License-Identifier: Apache-2.0
// What surrounds the integrators: filters, films that stop by the clock or belong to another scene, the
// direct integrator, metals by name, materials that a file does not name.
#include <gtest/gtest.h>

#include <cmath>

#include "../scratch.hpp"
#include "reflectree/error.hpp"
#include "reflectree/render/film/film.hpp"

namespace reflectree::render {
namespace {

std::string scene_of(const std::string& rest, const std::string& filter = "<rfilter type=\"box\"/>",
                     const std::string& integrator = "<integrator type=\"path\"/>") {
  return "<scene version=\"3.0.0\"><default name=\"albedo\" value=\".5\"/>" + integrator + R"(
  <sensor type="perspective"><float name="fov" value="90"/>
    <transform name="to_world"><lookat origin="0,0,1" target="0,0,0" up="0,1,0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="4"/></sampler>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/>)" +
         filter + "</film></sensor>" + rest + "</scene>";
}

// Light fills the half of the picture to the left of x = 0: the eye is at distance 1, a pixel is 1/8 wide.
const char* half =
    R"(<shape type="rectangle"><transform name="to_world"><translate x="-1"/><scale x="5" y="9" z="1"/>
  </transform><emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>)";

// The mean over the rows of column x, which lies x - 7.5 pixels to the right of the edge.
double column(const Image& image, int x) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y) sum += double(image.values[image.index(x, y)]) / image.height;
  return sum;
}

TEST(Filters, SpreadAnEdgeByTheirOwnIntegral) {
  const auto gauss = [](double x) { return .5 * std::erfc(x / (.7 * std::sqrt(2.))); };
  const auto tent = [](double x) {
    return x >= 1.5 ? 0
           : x >= 0 ? .5 * std::pow(1 - x / 1.5, 2)
                    : 1 - .5 * std::pow(1 + std::max(x, -1.5) / 1.5, 2);
  };
  const auto box = [](double x) { return std::clamp(.5 - x / 1.5, 0., 1.); };
  const auto worst = [](const std::string& filter, auto expected) {
    const Image image = render(parse_scene(scene_of(half, filter), "half.xml"), {.samples = 2048, .seed = 5});
    double difference = 0;
    for (int x = 4; x < 12; ++x)
      difference = std::max(difference, std::abs(column(image, x) - expected(x - 7.5)));
    return difference;
  };
  constexpr double allowed = .012;  // five standard errors of 32768 samples of 0 or 1
  const std::string gaussian = R"(<rfilter type="gaussian"><float name="stddev" value=".7"/></rfilter>)",
                    tented = R"(<rfilter type="tent"><float name="radius" value="1.5"/></rfilter>)",
                    boxed = R"(<rfilter type="box"><float name="radius" value=".75"/></rfilter>)";
  EXPECT_LT(worst(gaussian, gauss), allowed);
  EXPECT_LT(worst(tented, tent), allowed);
  EXPECT_LT(worst(boxed, box), allowed);
  EXPECT_GT(worst(gaussian, tent), allowed) << "the twins";
  EXPECT_GT(worst(tented, box), allowed);
}

const char* wall = R"(<emitter type="constant"><rgb name="radiance" value="1"/></emitter>
  <shape type="cube"><boolean name="flip_normals" value="true"/><transform name="to_world"><scale value="3"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="$albedo"/></bsdf></shape>
  <shape type="sphere"><float name="radius" value=".2"/><emitter type="area"><rgb name="radiance" value="2"/></emitter></shape>)";

TEST(Film, ByTheClockHoldsWholePassesOfTheSamePicture) {
  const Scene scene = parse_scene(scene_of(wall), "wall.xml");
  Film film;
  ASSERT_TRUE(render_into(film, scene, {.seed = 3, .seconds = 1e-9}));
  EXPECT_EQ(film.samples, 1) << "the first pass is always made";
  ASSERT_TRUE(render_into(film, scene, {.seed = 3, .seconds = .05}));
  ASSERT_GT(film.samples, 1);
  EXPECT_EQ(to_image(film).values, render(scene, {.samples = film.samples, .seed = 3}).values);
}

TEST(Film, OfAnotherSceneOrOtherOptionsIsRefused) {
  const std::string xml = scene_of(wall);
  const Scene scene = parse_scene(xml, "wall.xml");
  Film film;
  ASSERT_TRUE(render_into(film, scene, {.samples = 1}));
  const std::string file = scratch("rim.sums");
  save_film(file, film);
  const auto goes_on = [&](const Scene& with, const RenderOptions& how) {
    Film again = load_film(file);
    try {
      return render_into(again, with, how);
    } catch (const Error&) {
      return false;
    }
  };
  EXPECT_TRUE(goes_on(scene, {.samples = 2}));
  std::string spaced = xml;
  spaced.insert(spaced.find("<sensor"), "<!-- the same -->\n");
  EXPECT_TRUE(goes_on(parse_scene(spaced, "elsewhere.xml"), {.samples = 2}));
  EXPECT_FALSE(goes_on(parse_scene(xml, "wall.xml", {.defines = {{"albedo", ".6"}}}), {.samples = 2}));
  EXPECT_FALSE(goes_on(parse_scene(xml, "wall.xml", {{}, "exact"}), {.samples = 2}));
  EXPECT_FALSE(goes_on(scene, {.samples = 2, .technique = Technique::power}));
  EXPECT_FALSE(goes_on(scene, {.samples = 2, .seed = 2}));
  Scene split = scene;
  split.transport.split = 4;
  EXPECT_FALSE(goes_on(split, {.samples = 2}));
}

// What looks otherwise in Mitsuba is said.
TEST(Direct, LampsOfAPointCountOnceAndTheReaderSaysSo) {
  const auto notes = [](const std::string& samples, const std::string& lamp) {
    const std::string film = R"(<sensor type="perspective"><film type="hdrfilm"/></sensor>)";
    return parse_scene("<scene><integrator type=\"direct\"><integer name=\"emitter_samples\" value=\"" +
                           samples + "\"/></integrator>" + film + "<emitter type=\"" + lamp + "\"/></scene>",
                       "lamps.xml")
        .notes;
  };
  ASSERT_EQ(notes("4", "point").size(), 1U);
  EXPECT_NE(notes("4", "point").front().find("in Mitsuba 4 times"), std::string::npos);
  EXPECT_TRUE(notes("1", "point").empty());
  EXPECT_TRUE(notes("4", "constant").empty());
}

TEST(Materials, MetalsHaveNamesAndLightsAreBlack) {
  const auto first = [](const std::string& bsdf) {
    return parse_scene(scene_of("<shape type=\"sphere\">" + bsdf + "</shape>"), "ball.xml").surfaces.front();
  };
  PathBits u;
  const auto mirrored = [&](const std::string& bsdf) {
    return first(bsdf).scattering->sample({0, 0, 1}, {}, u)->weight;
  };
  const auto metal = [](const std::string& name) {
    return "<bsdf type=\"conductor\"><string name=\"material\" value=\"" + name + "\"/></bsdf>";
  };
  const Rgb copper = mirrored(metal("Cu")), silver = mirrored(metal("Ag"));
  // ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2) at normal incidence.
  EXPECT_NEAR(copper.r,
              (std::pow(.201005 - 1, 2) + 3.91326 * 3.91326) / (std::pow(1.201005, 2) + 3.91326 * 3.91326),
              1e-5);
  EXPECT_LT(copper.b, copper.r - .2f) << "copper is red";
  EXPECT_GT(silver.b, .85f) << "and silver is not";
  EXPECT_EQ(mirrored("<bsdf type=\"conductor\"/>"), (Rgb{1, 1, 1}));
  EXPECT_THROW(first(metal("Unobtainium")), Error);
  EXPECT_EQ(first("<emitter type=\"area\"/>").scattering->f_cos({0, 0, 1}, {0, 0, 1}, {}), Rgb{});
  EXPECT_NEAR(first("").scattering->f_cos({0, 0, 1}, {0, 0, 1}, {}).g, .5f / pi, 1e-6f);
}

}  // namespace
}  // namespace reflectree::render
