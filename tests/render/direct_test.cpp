// SPDX-License-Identifier: Apache-2.0
// Direct lighting against closed forms and path tracing; furnaces through recursive ray tracing, resampling
// and photon mapping.
#include <gtest/gtest.h>

#include "reflectree/brdf/material/material.hpp"
#include "small_scenes.hpp"

namespace reflectree::render {
namespace {

using Method = Transport::Method;

Scene direct_of(Scene scene, int split) {
  scene.transport.method = Method::direct, scene.transport.split = split;
  return scene;
}

TEST(Direct, APointLightOnALambertianFloorIsTheClosedForm) {
  Scene scene = direct_of(
      parse_scene(small_scene("9",
                              wall(R"(<scale value="3"/>)", grey("0.5")) +
                                  wall(R"(<scale value="3"/><translate z="9"/>)", grey("0.9")) +
                                  R"(<emitter type="point"><point name="position" x="0.4" y="0.3" z="1.5"/>
        <rgb name="intensity" value="2"/></emitter>)",
                              "0,-2,2"),
                  "point.xml"),
      1);
  scene.points.kind = PointSet::Kind::sobol;
  const Image image = render(scene, {.samples = 256, .seed = 1});
  double sum = 0, exact = 0;
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      for (int s = 0; s < 64; ++s) {  // the pixel's mean; the ground is z = 0
        const float px = 1 - 2 * (float(x) + (float(s % 8) + .5f) / 8) / float(scene.width),
                    py = 1 - 2 * (float(y) + (float(s / 8) + .5f) / 8) / float(scene.height);
        const Camera& c = scene.camera;
        const Direction d = c.forward + (px * c.tan_x) * c.left + (py * c.tan_y) * c.up;
        const float t = -c.origin.z / d.z;
        const Point at = c.origin + t * d;
        if (!(t > 0) || std::abs(at.x) > 3 || std::abs(at.y) > 3) continue;
        const Point to = Point{.4f, .3f, 1.5f} - at;
        exact += double(2 * .5f / pi * to.z / std::pow(dot(to, to), 1.5f)) / 64;
      }
      sum += double(image.values[image.index(x, y)]);
    }
  }
  EXPECT_NEAR(sum / exact, 1, 1e-3);
  EXPECT_GT(std::abs(sum / exact * 1.01 - 1), 1e-3) << "a planted bias of 1 %";
}

TEST(Direct, EveryTechniqueShowsThePathTracersFirstBounce) {
  for (Scene scene : {corner(), under_the_sky()}) {
    scene.max_depth = 2;
    const Sight reference = look(scene, 8, 256, 1);
    for (const Technique t : {Technique::balance, Technique::power, Technique::light, Technique::resampled}) {
      for (const int split : {1, 8}) {
        // Surfaces rarely find small lamps: standard errors can be trusted only from many samples.
        const int samples = (t == Technique::resampled ? 1024 : 128) / split;
        const Sight s = look(direct_of(scene, split), 8, samples, 11, t);
        const Agreement same = agreement(s, reference), biased = agreement(s, reference, 1.05);
        EXPECT_TRUE(same(1.2)) << int(t) << ", " << split << ": " << same.mean << ", " << same.rms;
        EXPECT_FALSE(biased(1.2)) << int(t) << ", " << split << ": a planted bias of 5 %";
      }
    }
  }
}

// A sampler without a density leaves lamps to its own directions, but the sun is not found by chance.
struct Blind {
  using Value = Spectrum;
  AnySampler<Spectrum> own;
  template <RandomBits U>
  std::optional<DirectionSample<Spectrum>> sample(Direction wo, U& u) const {
    UniformBits bits(Pcg32((std::uint64_t(u()) << 32U) | u()));
    return own.sample(wo, bits);
  }
};

TEST(Direct, SamplersWithoutADensitySeeEveryLight) {
  const AnyBrdf f(OneWay{});
  const Scene seeing = one_way(sampled(f, one_shot_of(f))),
              blind = one_way(sampled(f, AnySampler<Spectrum>("blind", Blind{one_shot_of(f)})));
  ASSERT_FALSE(blind.surfaces[blind.rectangles[0].surface].scattering->has_pdf());
  const Sight reference = look(seeing, 8, 256, 1);
  for (const Method method : {Method::path, Method::recursive, Method::photons}) {
    Scene scene = blind, dark = blind;
    scene.transport.method = method, scene.transport.photons = {3000, .1f, 2 / 3.f, true};
    dark.transport.method = method, dark.directional_lights.clear();
    const int samples = method == Method::path ? 512 : 64;
    EXPECT_TRUE(agreement(look(scene, 8, samples, 11), reference, 1, .01)(1.25)) << int(method);
    EXPECT_FALSE(agreement(look(dark, 2, samples, 11), reference, 1, .01)(1.25)) << "the twin: no sun";
  }
}

// Under a sky whose light lies within a patch, most directions of the surface bring nothing.
double variance(const Scene& scene, Technique technique) {
  const Image image = render(scene, {.samples = 64, .seed = 3, .technique = technique});
  double sum = 0;
  for (std::size_t i = 0; i < image.values.size(); i += 6)
    sum += double(image.values[i + 3]) * double(image.values[i + 3]);
  return sum;
}

TEST(Direct, ResampledDirectionsHaveLessVarianceForOneShadowRay) {
  const Scene scene = corner();
  Scene lamps = scene;  // the disk alone, which is what is resampled
  lamps.point_lights.clear();
  const double plain = variance(direct_of(lamps, 1), Technique::surface),
               resampled = variance(direct_of(lamps, 16), Technique::resampled),
               one = variance(direct_of(lamps, 1), Technique::resampled);
  std::printf("variance with 16 candidates: %.3f of the surface's directions alone\n", resampled / plain);
  EXPECT_LT(resampled / plain, .2);
  EXPECT_NEAR(one / plain, 1, .2) << "the twin: one candidate is no gain";
}

Scene furnace_wall() {
  return parse_scene(small_scene("-1", R"(<emitter type="constant"><rgb name="radiance" value="1"/></emitter>
    <shape type="rectangle"><transform name="to_world"><scale value="9"/></transform><bsdf type="reflectree">
      <string name="material" value="ggx:alpha=0.4,f0=0.8"/></bsdf></shape>)",
                                 "0,-.6,1.4"),
                     "furnace.xml");
}

// The albedo seen, from the midpoint rule over the projected disk.
double albedo_seen(const Scene& scene) {
  const AnyBrdf f = make_brdf(parse_material("ggx:alpha=0.4,f0=0.8"));
  const Camera& c = scene.camera;
  double total = 0;
  for (int i = 0; i < scene.width * scene.height; ++i) {
    const float px = 1 - 2 * (float(i % scene.width) + .5f) / float(scene.width),
                py = 1 - 2 * (float(i / scene.width) + .5f) / float(scene.height);
    const Direction wo = -normalize(c.forward + (px * c.tan_x) * c.left + (py * c.tan_y) * c.up);
    constexpr int n = 100;
    for (int k = 0; k < n * n; ++k) {
      const double r2 = (k / n + .5) / n, phi = 2 * M_PI * (k % n + .5) / n;
      const Direction wi{float(std::sqrt(r2) * std::cos(phi)), float(std::sqrt(r2) * std::sin(phi)),
                         float(std::sqrt(1 - r2))};
      total += double(eval(f, wo, wi)[0]) * M_PI / (n * n);
    }
  }
  return total / (scene.width * scene.height);
}

TEST(Furnace, RecursiveAndResampledShowTheAlbedo) {
  Scene scene = furnace_wall();
  const double albedo = albedo_seen(scene);
  const auto judge = [&](const char* name, Technique technique) {
    const Sight s = look(scene, 4, 96, 5, technique);
    std::printf("%s: %.5f of the albedo, +- %.5f\n", name, s.mean / albedo, s.error / albedo);
    EXPECT_NEAR(s.mean / albedo, 1, 1e-3) << name;
    EXPECT_GT(std::abs(s.mean / albedo * 1.003 - 1), 1e-3) << name << ": a planted bias of .3 %";
  };
  scene.transport.method = Method::recursive;
  judge("recursive", Technique::balance);
  scene.transport.method = Method::direct;
  judge("resampled", Technique::resampled);
}

// Inside a shining sphere of albedo 1/2 radiance is 2 everywhere: 1 / (1 - albedo). A lookup loses what comes
// so low that it lies below the horizon of the place that is asked for: delta^2 / 4 of the light at an angle
// delta about the centre, r^2 / (12 R^2) over the kernel. A cap whose chord is r has the area of a flat disk:
// there is no other bias. Half of the radiance seen has been looked up.
TEST(Furnace, PhotonsInsideAShiningSphereKeepEnergy) {
  Scene scene = parse_scene(
      small_scene("-1",
                  R"(<shape type="sphere"><point name="center" x="0" y="0" z="0"/>
      <float name="radius" value="3"/><boolean name="flip_normals" value="true"/>)" +
                      grey("0.5") + R"(<emitter type="area"><rgb name="radiance" value="1"/></emitter>
      </shape>)",
                  "0,-1,0.6"),
      "inside.xml");
  scene.transport.method = Method::photons;
  for (const bool gather : {true, false}) {
    scene.transport.photons = {20000, .4f, 1, gather};
    const Sight s = look(scene, 8, 10, 1);
    const double expected = 2 - .5 * .4 * .4 / (12 * 3 * 3);
    std::printf("photons%s: %.5f +- %.5f, expected %.5f\n", gather ? "" : " without gathering", s.mean,
                s.error, expected);
    EXPECT_LT(std::abs(s.mean - expected), 4.5 * s.error);
    EXPECT_GT(std::abs(1.015 * s.mean - expected), 4.5 * s.error) << "a planted bias of 1.5 %";
    EXPECT_NEAR(s.mean, 2, gather ? 2e-3 : 8e-3) << "within .1 %";
  }
}

}  // namespace
}  // namespace reflectree::render
