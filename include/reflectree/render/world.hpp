// SPDX-License-Identifier: Apache-2.0
// What every integrator asks of a scene: where rays end, where they start, and light that comes straight from
// its source, with multiple importance sampling (Veach 1997, 9.2.2).
#pragma once

#include "reflectree/render/lights/lights.hpp"

namespace reflectree::render {

// Whether next-event estimation may count a sample: where a surface's directions have no density, they are
// left to find what they can, all but points and directions.
inline bool competes(const LightSample& light, const Scattering& scattering) {
  return light.pdf > 0 && (light.delta || scattering.has_pdf());
}

// Of a technique with density `own` > 0 against the one with `other`.
inline float heuristic(Technique technique, float own, float other) {
  if (technique != Technique::power) return own / (own + other);
  const float ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

// A place where a path meets a surface; `wo` goes back along it, in the shading frame.
struct PathVertex {
  PathVertex(const Scene& scene, const Hit& hit, Point origin, Direction direction);
  Interaction on;
  const Surface* surface;
  LocalFrame<float> frame;  // its x follows u where the material asks for that
  Direction wo;
  std::optional<SurfaceDetail> detail;  // where the material asks for it
  const Scattering& scattering() const { return *surface->scattering; }
  // What its material says, booked for --profile.
  Scattering::Value value(Direction wi) const;
  Rgb f_cos(Direction wi) const;
  std::optional<Scattered> sample(PathBits& u) const;
  std::size_t sample_n(std::span<PathBits> u, std::span<Scattered> out) const;
  std::optional<Scattered> sample_adjoint(PathBits& u) const;  // light comes from wo
  // Light that it emits back.
  Rgb emitted() const { return wo.z > 0 ? radiance_of(*surface, on.uv) : Rgb{}; }
  // Valid as long as the vertex stays where it is.
  Place place() const { return {on.uv, detail ? &*detail : nullptr}; }

 private:
  void follow_texture(const Scene& scene, const Hit& hit, Direction direction, bool in_detail);
};

struct World {
  explicit World(const Scene& scene);  // holds a reference

  // How far from a surface rays start: well above the rounding of its coordinates.
  float near(Point at) const { return 5e-5f * max(max(max(abs(at.x), abs(at.y)), abs(at.z)), .01f * extent); }
  // Between the camera's clips.
  Ray camera_ray(Point origin, Direction direction) const {
    const float cosine = dot(direction, scene.camera.forward);
    return {origin, direction, scene.camera.near / cosine, scene.camera.far / cosine};
  }
  // Stops short of what it leads to.
  Ray shadow_ray(Point at, Direction direction, float distance) const {
    const float start = near(at);
    return {at, direction, start, std::isinf(distance) ? distance : distance * (1 - 1e-4f) - start};
  }
  // What the camera's ray shows: where lamps are hidden, the first surface that is none.
  std::optional<Hit> seen(const Ray& ray) const { return past_lamps(ray, embree.intersect(ray)); }
  std::optional<Hit> past_lamps(const Ray& ray, std::optional<Hit> hit) const;
  // Of the sky, as the camera sees it.
  Rgb backdrop(Direction direction) const {
    return scene.environment && !scene.hide_lamps ? scene.environment->radiance(direction) : Rgb{};
  }
  bool sees(Point at, Direction direction, float distance) const;
  // Next-event estimation: what a light sends to a vertex, reflected back, if nothing stands in between,
  // weighed against the directions that the surface would draw.
  static Rgb unshadowed(const LightSample& light, const Scattering::Value& value, Technique technique);
  Rgb direct(const PathVertex& at, Technique technique, PathBits& u) const;

  const Scene& scene;
  EmbreeScene embree;
  Lights lights;
  float extent = 0;
};

}  // namespace reflectree::render
