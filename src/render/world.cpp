// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/world.hpp"

#include <algorithm>
#include <cmath>

#include "flat.hpp"
#include "reflectree/render/profile.hpp"

namespace reflectree::render {

bool competes(const LightSample& light, const Scattering& scattering) {
  return light.pdf > 0 && (light.delta || scattering.has_pdf());
}

namespace {
float largest(Point p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }
}  // namespace

float heuristic(Technique technique, float own, float other) {
  if (technique != Technique::power) return own / (own + other);
  const float ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

PathVertex::PathVertex(const Scene& scene, const Hit& hit, Point origin, Direction direction)
    : on(interaction_at(scene, hit, origin, direction)),
      frame(frame_from_normal(on.shading)),
      wo(to_local(frame, -direction)),
      surface(&scene.surfaces[on.surface]) {}

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

float World::near(Point at) const { return 5e-5f * std::max(largest(at), .01f * extent); }

Ray World::shadow_ray(Point at, Direction direction, float distance) const {
  const float start = near(at);
  return {at, direction, start, std::isinf(distance) ? distance : distance * (1 - 1e-4f) - start};
}

bool World::sees(Point at, Direction direction, float distance) const {
  return !embree.occluded(shadow_ray(at, direction, distance));
}

Lit World::unshadowed(Point at, const LightSample& light, const Scattering::Value& value,
                      Technique technique) const {
  const Rgb arriving = value.f_cos * light.radiance;
  if (arriving == Rgb{}) return {};
  const bool alone = light.delta || technique == Technique::light;
  const float share = alone ? 1 : heuristic(technique, light.pdf, value.pdf);
  return {(share / light.pdf) * arriving, shadow_ray(at, light.direction, light.distance)};
}

Rgb World::direct(const PathVertex& at, Technique technique, PathBits& u) const {
  const auto light = lights.sample(at.on.at, u);
  if (!light || !competes(*light, at.scattering())) return {};
  const Lit lit = unshadowed(at.on.at, *light, at.value(to_local(at.frame, light->direction)), technique);
  return lit.radiance == Rgb{} || embree.occluded(lit.towards) ? Rgb{} : lit.radiance;
}

}  // namespace reflectree::render
