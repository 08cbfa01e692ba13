// SPDX-License-Identifier: Apache-2.0
// Every light of a scene, one of them drawn for a point that is lit. All are equally likely: meshes (then
// uniform in area, as rectangles and disks are), spheres (uniform in the cone they fill), points, directions
// and the environment.
#pragma once

#include "reflectree/render/shapes/embree_scene.hpp"

namespace reflectree::render {

struct LightSample {
  Direction direction;  // towards the light
  float distance;
  float pdf;  // per solid angle; 1 and `delta` where there is no density
  bool delta;
  Rgb radiance;  // or irradiance, of a delta
};

class Lights {
 public:
  explicit Lights(const Scene& scene);  // holds a reference

  std::optional<LightSample> sample(Point at, PathBits& u) const;
  // One for each point, from its bits.
  void sample(std::span<const Point> at, std::span<PathBits* const> u,
              std::span<std::optional<LightSample>> out) const;
  // Density with which `sample` finds what a ray from `at` has hit; 0 for what does not shine.
  float pdf(Point at, Direction direction, const Hit& hit, const Interaction& on) const;
  // What the environment sends, and the density with which `sample` finds it.
  Environment::Light environment(Direction direction) const;
  void environment(std::span<const Direction> directions, std::span<Environment::Light> out) const;

 private:
  // A triangle that shines, at + b ab + c ac; its normal is zero where it turns with the shading normal.
  struct Part {
    std::uint32_t triangle;
    Point at;
    Direction ab, ac, normal;
  };
  struct Light {
    enum class Kind { mesh, sphere, rectangle, disk, cylinder, point, spot, directional, environment } kind;
    std::uint32_t index;  // among its kind; of a mesh, its surface
    Rgb radiance;         // of surfaces
    float density;        // of their points, per area, times share_
    bool pictured;        // not alike all over
    std::vector<Part> parts;
    std::vector<double> cdf;  // of their areas
  };
  // Of a pictured lamp, where it was drawn.
  void look_up(const Hit& hit, Point at, std::optional<LightSample>& s) const;
  const Light& chosen(PathBits& u) const;
  void sample_light(const Light& light, Point at, PathBits& u, std::optional<LightSample>& s) const;

  const Scene& scene_;
  std::vector<Light> lights_;
  float share_ = 0;           // of each light
  std::vector<double> area_;  // of a surface's triangles, where they shine
};

}  // namespace reflectree::render
