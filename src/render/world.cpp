// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/world.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/render/integrators/profile.hpp"
#include "shapes/flat.hpp"

namespace reflectree::render {

namespace {
float largest(Point p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }
}  // namespace

PathVertex::PathVertex(const Scene& scene, const Hit& hit, Point origin, Direction direction)
    : on(interaction_at(scene, hit, origin, direction)),
      surface(&scene.surfaces[on.surface]),
      frame(surface->scattering->follows_texture() ? frame_along(on.shading, tangents_at(scene, hit, on).du)
                                                   : frame_from_normal(on.shading)),
      wo(to_local(frame, -direction)) {}

Scattering::Value PathVertex::value(Direction wi) const {
  const InPhase evaluating(Phase::eval);
  return scattering().value(wo, wi, on.uv);
}

Rgb PathVertex::f_cos(Direction wi) const {
  const InPhase evaluating(Phase::eval);
  return scattering().f_cos(wo, wi, on.uv);
}

std::optional<Scattered> PathVertex::sample(PathBits& u) const {
  const InPhase sampling(Phase::sample);
  return scattering().sample(wo, on.uv, u);
}

std::size_t PathVertex::sample_n(std::span<PathBits> u, std::span<Scattered> out) const {
  const InPhase sampling(Phase::sample);
  return scattering().sample_n(wo, on.uv, u, out);
}

std::optional<Scattered> PathVertex::sample_adjoint(PathBits& u) const {
  const InPhase sampling(Phase::sample);
  return scattering().sample_adjoint(wo, on.uv, u);
}

World::World(const Scene& s) : scene(s), embree(s), lights(s) {
  for (const Vertex& v : scene.vertices) extent = std::max(extent, largest(v.at));
  for (const Sphere& sphere : scene.spheres) extent = std::max(extent, float(sphere.radius));
  for (const auto* all : {&scene.rectangles, &scene.disks}) {
    for (const Flat& f : *all) {
      for (const double x : {-1., 1.})
        extent = std::max({extent, largest(point_on(f, x, -1)), largest(point_on(f, x, 1))});
    }
  }
}

bool World::sees(Point at, Direction direction, float distance) const {
  return !embree.occluded(shadow_ray(at, direction, distance));
}

Rgb World::unshadowed(const LightSample& light, const Scattering::Value& value, Technique technique) {
  const Rgb arriving = value.f_cos * light.radiance;
  if (arriving == Rgb{}) return {};
  const bool alone = light.delta || technique == Technique::light;
  const float share = alone ? 1 : heuristic(technique, light.pdf, value.pdf);
  return (share / light.pdf) * arriving;
}

Rgb World::direct(const PathVertex& at, Technique technique, PathBits& u) const {
  const auto light = lights.sample(at.on.at, u);
  if (!light || !competes(*light, at.scattering())) return {};
  const Rgb lit = unshadowed(*light, at.value(to_local(at.frame, light->direction)), technique);
  return lit != Rgb{} && sees(at.on.at, light->direction, light->distance) ? lit : Rgb{};
}

}  // namespace reflectree::render
