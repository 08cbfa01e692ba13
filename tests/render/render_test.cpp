// SPDX-License-Identifier: Apache-2.0
// The path tracer against closed forms and against itself; bad scenes end in a clear Error.
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "../error_words.hpp"
#include "../scratch.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/error.hpp"
#include "reflectree/render/film/film.hpp"

namespace reflectree::render {
namespace {

constexpr const char* sensor = R"(
  <sensor type="perspective"><float name="fov" value="20"/>
    <transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="8"/>
      <rfilter type="box"/></film></sensor>)";

std::string scene_of(const std::string& rest, const std::string& depth = "-1") {
  return "<scene version=\"3.0.0\"><default name=\"spp\" value=\"64\"/><integrator type=\"path\">"
         "<integer name=\"max_depth\" value=\"" +
         depth + "\"/></integrator>" + sensor + rest + "</scene>";
}

struct Mean {
  double value = 0, error = 0;
};
Mean mean_of(const Image& image) {
  Mean m;
  const auto pixels = double(image.width * image.height);
  for (std::size_t i = 0; i < image.values.size(); i += 6) {
    m.value += double(image.values[i]) / pixels;
    m.error += double(image.values[i + 3]) * double(image.values[i + 3]) / (pixels * pixels);
  }
  m.error = std::sqrt(m.error);
  return m;
}

// A wall that fills the picture, under a sky of radiance 1, seen from the front.
std::string furnace(const std::string& bsdf) {
  return scene_of(R"(<emitter type="constant"><rgb name="radiance" value="1"/></emitter>
    <shape type="rectangle">)" +
                  bsdf + "</shape>");
}

TEST(Render, FurnaceShowsTheAlbedoOfALambertianWall) {
  const Scene scene = parse_scene(
      furnace(R"(<bsdf type="diffuse"><rgb name="reflectance" value="0.3"/></bsdf>)"), "furnace.xml");
  const Mean m = mean_of(render(scene, {.samples = 16, .seed = 1, .technique = Technique::surface}));
  EXPECT_NEAR(m.value, .3, 1e-5);
  EXPECT_GT(std::abs(m.value - .3 * 1.001), 1e-5);  // the twin
  const Mean mis = mean_of(render(scene, {.samples = 256, .seed = 1}));
  EXPECT_LT(std::abs(mis.value - .3), 4 * mis.error);
}

// The albedo of a function from the midpoint rule over (cos theta, phi) alone, averaged over the pixels' wo.
double albedo_seen(const Scene& scene, const AnyBrdf& f) {
  double total = 0;
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const float px = 1 - 2 * (float(x) + .5f) / float(scene.width),
                  py = 1 - 2 * (float(y) + .5f) / float(scene.height);
      const Direction wo = normalize(Direction{px * scene.camera.tan_x, py * scene.camera.tan_y, 1});
      double sum = 0;
      constexpr int n = 200;
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const double r2 = (i + .5) / n, phi = 2 * M_PI * (j + .5) / n;
          const Direction wi{float(std::sqrt(r2) * std::cos(phi)), float(std::sqrt(r2) * std::sin(phi)),
                             float(std::sqrt(1 - r2))};
          sum += double(eval(f, wo, wi)[0]);
        }
      }
      total += sum * M_PI / (n * n);
    }
  }
  return total / (scene.width * scene.height);
}

TEST(Render, FurnaceShowsTheAlbedoOfAGlossyWallByEitherMode) {
  for (const char* sampler : {"exact", "one-shot"}) {
    SceneOptions options;
    options.sampler = sampler;
    const Scene scene = parse_scene(
        furnace(R"(<bsdf type="reflectree"><string name="material" value="ggx:alpha=0.4,f0=0.8"/></bsdf>)"),
        "furnace.xml", options);
    const Mean m = mean_of(render(scene, {.samples = 1024, .seed = 3}));
    const double albedo = albedo_seen(scene, make_brdf(parse_material("ggx:alpha=0.4,f0=0.8")));
    EXPECT_LT(std::abs(m.value / albedo - 1), 1e-3) << sampler << ": " << m.value << " and " << albedo;
    EXPECT_GT(std::abs(m.value * 1.003 / albedo - 1), 1e-3) << "a planted bias of .3 % must be seen";
  }
}

const std::string lit_wall = scene_of(R"(
    <shape type="rectangle"><bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf></shape>
    <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="110"/><translate x="-2" z="1"/></transform>
      <bsdf type="diffuse"/><emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>)",
                                      "3");

// Uniform directions with no density to weigh lights against.
struct Chance {
  using Value = Spectrum;
  std::optional<DirectionSample<Spectrum>> sample(Direction wo, UniformBits& u) const { return draw(wo, u); }
  std::optional<DirectionSample<Spectrum>> sample(Direction wo, Pcg32& u) const { return draw(wo, u); }
  template <class U>
  static std::optional<DirectionSample<Spectrum>> draw(Direction wo, U& u) {
    if (!(wo.z > 0)) return std::nullopt;
    const float z = to_unit_float(u()), phi = 2 * pi * to_unit_float(u()), r = std::sqrt(1 - z * z);
    Spectrum weight(3);
    for (int k = 0; k < 3; ++k) weight[k] = z;  // uniform: f cos / pdf = 0.5 / pi cos 2 pi
    return DirectionSample<Spectrum>{{r * std::cos(phi), r * std::sin(phi), z}, 0, weight, sample_reflection};
  }
};

// Two parallel facing lights and walls: next-event estimation and MIS against chance hits alone.
TEST(Render, LightsAreFoundBySamplingThemAndByChanceAlike) {
  const Scene scene = parse_scene(lit_wall, "lights.xml");
  Scene dim = scene;  // the same without next-event estimation: a sampler that has no density
  for (Surface& s : dim.surfaces) {
    const auto f = [](Direction, Direction) { return .5f / pi; };
    s.scattering = sampled(AnyBrdf(f), AnySampler<Spectrum>("chance", Chance{}));
  }
  const Mean a = mean_of(render(scene, {.samples = 256, .seed = 1})),
             b = mean_of(render(dim, {.samples = 2048, .seed = 2}));
  const double z = (a.value - b.value) / std::hypot(a.error, b.error);
  EXPECT_LT(std::abs(z), 4) << a.value << " and " << b.value;
  EXPECT_GT(std::abs(a.value * 1.05 - b.value) / std::hypot(a.error, b.error), 4) << "a planted bias of 5 %";
}

TEST(Render, ThePictureIsTheSameForAnyNumberOfThreads) {
  const Scene scene = parse_scene(lit_wall, "lights.xml");
  Host host;
  host.parallel_for = [](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body) {
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < n; ++i) threads.emplace_back([&body, i] { body(i, i + 1); });
    for (std::thread& t : threads) t.join();
  };
  EXPECT_EQ(render(scene, {.samples = 8, .seed = 5}).values,
            render(scene, {.samples = 8, .seed = 5}, host).values);
  EXPECT_NE(render(scene, {.samples = 8, .seed = 5}).values, render(scene, {.samples = 8, .seed = 6}).values);
}

std::string error_of(const std::string& xml) {
  return error_words([&] { parse_scene(xml, "bad.xml"); });
}

TEST(Render, BadScenesNameWhatIsWrongAndWhere) {
  const std::pair<std::string, const char*> cases[] = {
      {"<scene>", "bad.xml:1:"},
      {"<other/>", "no <scene>"},
      {scene_of("<shape type=\"torus\"/>"), "'torus'"},
      {"<scene><integrator type=\"guess\"/></scene>", "'guess'"},
      {"<scene><integrator type=\"path\"><integer name=\"rr_depth\" value=\"1e81\"/></integrator></scene>",
       "whole number"},
      {"<scene><integrator type=\"path\"><integer name=\"split\" value=\"4\"/></integrator></scene>",
       "'split'"},
      {scene_of("<integrator type=\"path\"/>"), "a second <integrator>"},
      {scene_of("<shape type=\"rectangle\"><bsdf type=\"velvet\"/></shape>"), "'velvet'"},
      {scene_of("<shape type=\"rectangle\"><float name=\"radius\" value=\"1\"/></shape>"), "'radius'"},
      {scene_of("<shape type=\"rectangle\"><ref id=\"nobody\"/></shape>"), "'nobody'"},
      {scene_of("<bsdf type=\"twosided\" id=\"a\"><ref id=\"a\"/></bsdf>"
                "<shape type=\"rectangle\"><ref id=\"a\"/></shape>"),
       "circle"},
      {scene_of("<shape type=\"rectangle\"><transform name=\"to_world\"><translate "
                "x=\"nan\"/></transform></shape>"),
       "finite"},
      {scene_of("<shape type=\"rectangle\"><transform name=\"to_world\"><rotate "
                "angle=\"9\"/></transform></shape>"),
       "finite"},
      {scene_of("<shape type=\"rectangle\"><transform name=\"to_world\"><scale "
                "value=\"1e200\"/></transform></shape>"),
       "beyond 1e15"},
      {scene_of("<shape type=\"sphere\"><float name=\"radius\" value=\"1e16\"/></shape>"), "beyond 1e15"},
      {scene_of("<shape type=\"sphere\"><point name=\"center\" x=\"1e16\" y=\"0\" z=\"0\"/></shape>"),
       "beyond 1e15"},
      {scene_of("<emitter type=\"point\"><point name=\"position\" value=\"0,-1e25,0\"/></emitter>"),
       "beyond 1e15"},
      {"<scene><sensor type=\"perspective\"><transform name=\"to_world\"><lookat origin=\"3e25,-4,1\" "
       "target=\"0,0,0\" up=\"0,0,1\"/></transform><film type=\"hdrfilm\"/></sensor></scene>",
       "beyond 1e15"},
      {scene_of("<shape type=\"obj\"><string name=\"filename\" value=\"nothing.obj\"/></shape>"),
       "no such file"},
      {"<scene><sensor type=\"perspective\"/></scene>", "without a film"},
      {"<scene><sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" value=\"0\"/>"
       "<rfilter type=\"box\"/></film></sensor></scene>",
       "without pixels"},
      {"<scene><sensor type=\"perspective\"><float name=\"fov\" value=\"$f\"/><film type=\"hdrfilm\">"
       "<rfilter type=\"box\"/></film></sensor></scene>",
       "-D f=VALUE"},
  };
  for (const auto& [xml, words] : cases) {
    EXPECT_NE(error_of(xml).find(words), std::string::npos) << words << " in: " << error_of(xml);
  }
}

TEST(Render, StoppedAndResumedIsUninterrupted) {
  const Scene scene = parse_scene(lit_wall, "lights.xml");
  const std::string file = scratch("film.sums");
  Film film;
  ASSERT_TRUE(render_into(film, scene, {.samples = 11, .seed = 3}));
  save_film(file, film);
  Film resumed = load_film(file);
  EXPECT_EQ(resumed.samples, 11);
  Host stops;  // in the second pass after the resumption
  int polls = 0;
  stops.cancelled = [&] { return ++polls > 12; };
  EXPECT_FALSE(render_into(resumed, scene, {.samples = 40, .seed = 3}, stops));
  EXPECT_EQ(resumed.samples, 19) << "whole passes are kept";
  ASSERT_TRUE(render_into(resumed, scene, {.samples = 40, .seed = 3}));
  EXPECT_EQ(to_image(resumed).values, render(scene, {.samples = 40, .seed = 3}).values);
  EXPECT_NE(to_image(film).values, to_image(resumed).values);
  EXPECT_THROW(render_into(resumed, scene, {.samples = 50, .seed = 4}), Error);
}

TEST(Render, EveryTechniqueConvergesToTheSameImage) {
  const Scene scene = parse_scene(lit_wall, "lights.xml");
  const Mean balance = mean_of(render(scene, {.samples = 256, .seed = 1}));
  for (const Technique t : {Technique::power, Technique::light, Technique::surface}) {
    const Mean m = mean_of(render(scene, {.samples = 1024, .seed = 2, .technique = t}));
    const double error = std::hypot(m.error, balance.error);
    EXPECT_LT(std::abs(m.value - balance.value), 4 * error) << int(t);
    EXPECT_GT(std::abs(m.value * 1.1 - balance.value), 4 * error) << int(t) << ": a planted bias of 10 %";
  }
}

TEST(Render, ShapesWithoutAreaAreLeftOut) {
  const std::string none = "<transform name=\"to_world\"><scale x=\"0\"/></transform></shape>";
  const Scene scene = parse_scene(scene_of("<shape type=\"rectangle\">" + none + "<shape type=\"disk\">" +
                                           none + "<shape type=\"cube\">" + none),
                                  "flat.xml");
  EXPECT_TRUE(scene.rectangles.empty());
  EXPECT_TRUE(scene.disks.empty());
  EXPECT_EQ(scene.triangles.size(), 4) << "two sides of the cube are left";
  EXPECT_EQ(mean_of(render(scene, {.samples = 1, .seed = 1})).value, 0);
}

}  // namespace
}  // namespace reflectree::render
