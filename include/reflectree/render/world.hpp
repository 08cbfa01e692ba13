// SPDX-License-Identifier: Apache-2.0
// What every integrator asks of a scene: where rays end, where they start, and light that comes straight from
// its source, with multiple importance sampling (Veach 1997, 9.2.2).
#pragma once

#include "reflectree/render/lights.hpp"

namespace reflectree::render {

enum class Technique {
  balance,   // lights and the surface's own directions, weighed by the balance heuristic
  power,     // by the power heuristic, exponent 2
  light,     // lights alone; deltas still find them by chance
  surface,   // the surface's directions alone; point and directional lights stay dark
  resampled  // the surface's directions, resampled by the light that they see: direct lighting alone
};

// Whether next-event estimation may count a sample: where a surface's directions have no density, they are
// left to find what they can, all but points and directions.
bool competes(const LightSample& light, const Scattering& scattering);

// Of a technique with density `own` > 0 against the one with `other`.
float heuristic(Technique technique, float own, float other);

// A place where a path meets a surface; `wo` goes back along it, in the shading frame.
struct PathVertex {
  PathVertex(const Scene& scene, const Hit& hit, Point origin, Direction direction);
  Interaction on;
  Frame<float> frame;
  Direction wo;
  const Surface* surface;
  const Scattering& scattering() const { return *surface->scattering; }
  // What its material says, booked for --profile.
  Scattering::Value value(Direction wi) const;
  Rgb f_cos(Direction wi) const;
  std::optional<Scattered> sample(PathBits& u) const;
  std::size_t sample_n(std::span<PathBits> u, std::span<Scattered> out) const;
  std::optional<Scattered> sample_adjoint(PathBits& u) const;  // light comes from wo
  // Light that it emits back.
  Rgb emitted() const { return wo.z > 0 ? surface->radiance : Rgb{}; }
};

// Light that reaches a vertex, reflected back, if nothing stands in the ray's way.
struct Lit {
  Rgb radiance;
  Ray towards;
};

struct World {
  explicit World(const Scene& scene);  // holds a reference

  // How far from a surface rays start: well above the rounding of its coordinates.
  float near(Point at) const;
  // Stops short of what it leads to.
  Ray shadow_ray(Point at, Direction direction, float distance) const;
  bool sees(Point at, Direction direction, float distance) const;
  // Next-event estimation: a point on a light, weighed against the directions that the surface would draw.
  Lit unshadowed(Point at, const LightSample& light, const Scattering::Value& value,
                 Technique technique) const;
  Rgb direct(const PathVertex& at, Technique technique, PathBits& u) const;

  const Scene& scene;
  EmbreeScene embree;
  Lights lights;
  float extent = 0;
};

}  // namespace reflectree::render
