// SPDX-License-Identifier: Apache-2.0
// Small pictures for statistical tests of integrators, and how two of them are compared: by z-scores of
// pixels, and by means whose errors come from independent renders.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "reflectree/error.hpp"
#include "reflectree/peers/registry.hpp"
#include "reflectree/render/film/film.hpp"

namespace reflectree::render {

inline std::string small_scene(const std::string& depth, const std::string& rest, const std::string& eye) {
  return R"(<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value=")" + depth +
         R"("/></integrator><sensor type="perspective"><float name="fov" value="50"/>
    <transform name="to_world"><lookat origin=")" +
         eye + R"(" target="0,0,0.6" up="0,0,1"/></transform>
    <film type="hdrfilm"><integer name="width" value="20"/><integer name="height" value="14"/>
      <rfilter type="box"/></film></sensor>)" +
         rest + "</scene>";
}

inline std::string wall(const std::string& transform, const std::string& bsdf) {
  return R"(<shape type="rectangle"><transform name="to_world">)" + transform +
         R"(</transform><bsdf type="twosided">)" + bsdf + "</bsdf></shape>";
}

inline std::string grey(const std::string& value) {
  return R"(<bsdf type="diffuse"><rgb name="reflectance" value=")" + value + R"("/></bsdf>)";
}

// A floor under a lamp, a sun and a sky.
inline Scene lit_floor(const std::string& bsdf, const std::string& sampler) {
  SceneOptions options;
  options.sampler = sampler;
  return parse_scene(
      small_scene("3",
                  R"(<shape type="rectangle"><transform name="to_world"><scale value="3"/></transform>)" +
                      bsdf +
                      R"(</shape><emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>
    <emitter type="directional"><vector name="direction" x="0.2" y="0.5" z="-1"/><rgb name="irradiance" value="1"/>
    </emitter><shape type="disk"><transform name="to_world"><rotate x="1" angle="120"/><translate y="2" z="1.5"/>
    </transform><emitter type="area"><rgb name="radiance" value="2"/></emitter></shape>)",
                  "0,-4,1.4"),
      "floor.xml", options);
}

// A corner with a glossy ball, lit by a disk and a point; everything diffuse or glossy.
inline Scene corner() {
  return parse_scene(
      small_scene("6",
                  wall(R"(<scale value="2"/>)", grey("0.7, 0.6, 0.5")) +
                      wall(R"(<scale value="2"/><rotate x="1" angle="90"/><translate y="1.5" z="1"/>)",
                           grey("0.6, 0.7, 0.8")) +
                      R"(<shape type="sphere"><point name="center" x="0" y="0" z="0.6"/>
      <float name="radius" value="0.6"/><bsdf type="roughconductor"><float name="alpha" value="0.3"/>
      <string name="distribution" value="ggx"/><rgb name="eta" value="0.2,0.9,1.1"/>
      <rgb name="k" value="3.9,2.4,2.2"/></bsdf></shape>
    <shape type="disk"><transform name="to_world"><scale value="0.9"/><rotate x="1" angle="180"/>
      <translate x="-0.8" y="0.2" z="2.2"/></transform><emitter type="area"><rgb name="radiance" value="2"/></emitter>
      </shape><emitter type="point"><point name="position" x="1.4" y="-0.8" z="1.5"/>
      <rgb name="intensity" value="0.8,0.6,0.3"/></emitter>)",
                  "0.3,-4,1.4"),
      "corner.xml");
}

// A glass and a plastic ball under a sky and a large lamp: deltas on both sides.
inline Scene under_the_sky() {
  return parse_scene(
      small_scene("7",
                  wall(R"(<scale value="1.8"/>)", grey("0.6, 0.6, 0.6")) +
                      R"(<emitter type="constant"><rgb name="radiance" value="0.3,0.4,0.6"/></emitter>
    <shape type="sphere"><point name="center" x="-0.75" y="0" z="0.6"/><float name="radius" value="0.6"/>
      <bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf></shape>
    <shape type="sphere"><point name="center" x="0.75" y="0" z="0.6"/><float name="radius" value="0.6"/>
      <bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.5,0.2,0.1"/></bsdf></shape>
    <shape type="rectangle"><transform name="to_world"><scale value="1"/><rotate x="1" angle="180"/>
      <translate z="3"/></transform><emitter type="area"><rgb name="radiance" value="2"/></emitter></shape>)",
                  "0,-4,1.6"),
      "sky.xml");
}

// Reflects what comes steeply far better towards the side than the other way round.
struct OneWay {
  float operator()(Direction wo, Direction wi) const { return (.05f + .85f * (1 - wo.z) * wi.z * wi.z) / pi; }
};

inline AnySampler<Spectrum> one_shot_of(const AnyBrdf& f) {
  return *find_sampler("one-shot")->make({f, Material{}, {}}, Host{});
}

// A trough of non-reciprocal walls, one under the other, and a diffuse ball, lit from a direction and a disk.
inline Scene one_way(const ScatteringPtr& walls) {
  Scene scene = parse_scene(
      small_scene("6",
                  R"(<bsdf type="diffuse" id="w"/><shape type="rectangle"><transform name="to_world">
      <scale value="2"/></transform><ref id="w"/></shape><shape type="rectangle"><transform name="to_world">
      <scale value="2"/><rotate x="1" angle="70"/><translate y="1.2" z="1"/></transform><ref id="w"/></shape>
    <shape type="sphere"><point name="center" x="0" y="0" z="0.5"/><float name="radius" value="0.5"/>)" +
                      grey("0.8, 0.8, 0.8") + R"(</shape>
    <emitter type="directional"><vector name="direction" x="0.2" y="0.5" z="-1"/>
      <rgb name="irradiance" value="1.5,1.2,1"/></emitter>
    <shape type="disk"><transform name="to_world"><scale value="0.5"/><rotate x="1" angle="180"/>
      <translate x="0.5" y="-0.5" z="2.4"/></transform><emitter type="area"><rgb name="radiance" value="4"/></emitter>
      </shape>)",
                  "0,-4,1.5"),
      "one-way.xml");
  for (const Flat& r : scene.rectangles) scene.surfaces[r.surface].scattering = walls;
  return scene;
}

// A diffuse wall that the sun passes by and a floor under it lights: what the wall shows has been scattered
// once from light's side.
inline Scene lit_from_below(const ScatteringPtr& floor) {
  Scene scene = parse_scene(
      small_scene(
          "5",
          R"(<shape type="rectangle"><transform name="to_world"><scale value="1.5"/></transform></shape>)" +
              wall(R"(<scale value="1.5"/><rotate x="1" angle="90"/><translate y="1.5" z="1.5"/>)",
                   grey("0.7, 0.7, 0.7")) +
              R"(<emitter type="directional"><vector name="direction" x="0" y="0" z="-1"/>
      <rgb name="irradiance" value="2"/></emitter>)",
          "0,-3,1.5"),
      "below.xml");
  scene.surfaces[scene.rectangles[0].surface].scattering = floor;
  return scene;
}

// An octahedron that is shaded as a ball: true and shading normals differ by up to 55 degrees. What the wall
// and the floor show has come by way of it.
inline Scene gem() {
  Scene scene = parse_scene(
      small_scene(
          "5",
          wall(R"(<scale value="1.5"/><rotate x="1" angle="90"/><translate y="1.2" z="1"/>)",
               grey("0.7, 0.7, 0.7")) +
              R"(<shape type="rectangle"><transform name="to_world"><scale value="1.5"/></transform>)" +
              grey("0.9, 0.8, 0.7") +
              R"(</shape><emitter type="directional"><vector name="direction" x="0" y="0.1" z="1"/>
      <rgb name="irradiance" value="2"/></emitter><emitter type="directional">
      <vector name="direction" x="0.6" y="0.1" z="-0.7"/><rgb name="irradiance" value="2"/></emitter>)",
          "0,-4,1.2"),
      "gem.xml");
  const auto surface = std::uint32_t(scene.surfaces.size());
  scene.surfaces.push_back(
      {two_sided(diffuse({{.9f, .9f, .9f}, nullptr}), diffuse({{.9f, .9f, .9f}, nullptr})), {}});
  const auto first = std::uint32_t(scene.vertices.size());
  const Direction ends[] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const Direction d : ends) scene.vertices.push_back({Point{0, 0, .9f} + .8f * d, d, {}});
  for (std::uint32_t k = 0; k < 4; ++k) {
    scene.triangles.push_back({{first + k, first + (k + 1) % 4, first + 4}, surface});
    scene.triangles.push_back({{first + (k + 1) % 4, first + k, first + 5}, surface});
  }
  return scene;
}

// A rectangle as two triangles with one shading normal.
inline void add_triangles(Scene& scene, const Flat& f, Direction normal) {
  const auto first = std::uint32_t(scene.vertices.size());
  for (const auto& [x, y] : {Vec2<double>{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const Vec3<double> p = f.centre + x * f.s + y * f.t;
    scene.vertices.push_back(
        {{float(p.x), float(p.y), float(p.z)}, normal, {float((x + 1) / 2), float((y + 1) / 2)}});
  }
  scene.triangles.push_back({{first, first + 1, first + 2}, f.surface});
  scene.triangles.push_back({{first, first + 2, first + 3}, f.surface});
}

struct Sight {
  Image image;                 // the mean of all renders
  double mean = 0, error = 0;  // of the whole picture, from the renders' spread
};

// `renders` independent pictures of `samples` each; their passes stay comparable for progressive maps.
inline Sight look(const Scene& scene, int renders, int samples, std::uint64_t seed,
                  Technique technique = Technique::balance) {
  Sight sight;
  double squares = 0;
  for (int r = 0; r < renders; ++r) {
    const Image image =
        render(scene, {.samples = samples, .seed = seed + std::uint64_t(r), .technique = technique});
    if (r == 0) sight.image = make_image(image.width, image.height, image.channels);
    double mean = 0;
    for (std::size_t i = 0; i < image.values.size(); ++i) {
      const bool value = i % 6 < 3;
      sight.image.values[i] += (value ? image.values[i] : image.values[i] * image.values[i]) /
                               float(value ? renders : renders * renders);
      if (i % 6 < 3) mean += double(image.values[i]) / double(image.values.size() / 2);
    }
    sight.mean += mean / renders, squares += mean * mean / renders;
  }
  for (std::size_t i = 0; i < sight.image.values.size(); ++i) {
    if (i % 6 >= 3) sight.image.values[i] = std::sqrt(sight.image.values[i]);
  }
  sight.error = std::sqrt(std::max(0., squares - sight.mean * sight.mean) / (renders - 1));
  return sight;
}

struct Agreement {
  double rms = 0;   // of pixels' z-scores, 1 where two pictures differ by their noise alone
  double mean = 0;  // z-score of the whole
  bool operator()(double widest_rms) const { return rms < widest_rms && std::abs(mean) < 4.5; }
};

// `bias`: multiplies a, for twins. `slack`: of the mean, relative, for what blurs.
inline Agreement agreement(const Sight& a, const Sight& b, double bias = 1, double slack = 0) {
  Agreement result;
  double n = 0;
  for (std::size_t i = 0; i < a.image.values.size(); ++i) {
    if (i % 6 >= 3) continue;
    const auto va = double(a.image.values[i]), vb = double(b.image.values[i]);
    const double error = std::hypot(double(a.image.values[i + 3]), double(b.image.values[i + 3]));
    // Where the sky alone is seen there is no noise but rounding.
    if (!(error > 5e-4 * vb)) continue;
    const double z = (bias * va - vb) / error;
    result.rms += z * z, ++n;
  }
  result.rms = std::sqrt(result.rms / n);
  const double off = std::abs(bias * a.mean - b.mean) - slack * b.mean;
  result.mean = std::max(0., off) / std::hypot(a.error, b.error);
  return result;
}

}  // namespace reflectree::render
