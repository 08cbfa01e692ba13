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
      frame(frame_from_normal(on.shading)),
      wo(to_local(frame, -direction)) {
  const Scattering::Asks asks = surface->scattering->asks();
  if (asks != Scattering::Asks::nothing)
    follow_texture(scene, hit, direction, asks == Scattering::Asks::detail);
}

// Apart from the constructor: most materials do not ask for it.
[[gnu::noinline]] void PathVertex::follow_texture(const Scene& scene, const Hit& hit, Direction direction,
                                                  bool in_detail) {
  const Tangents along = tangents_at(scene, hit, on);
  frame = frame_along(on.shading, along.du);
  wo = to_local(frame, -direction);
  if (!in_detail) return;
  detail.emplace();
  detail->attributes = attributes_at(scene, hit);
  detail->du = to_local(frame, along.du), detail->dv = to_local(frame, along.dv);
  detail->face = to_local(frame, on.face);
}

Scattering::Value PathVertex::value(Direction wi) const {
  const InPhase evaluating(Phase::eval);
  return scattering().value(wo, wi, place());
}

Rgb PathVertex::f_cos(Direction wi) const {
  const InPhase evaluating(Phase::eval);
  return scattering().f_cos(wo, wi, place());
}

std::optional<Scattered> PathVertex::sample(PathBits& u) const {
  const InPhase sampling(Phase::sample);
  return scattering().sample(wo, place(), u);
}

std::size_t PathVertex::sample_n(std::span<PathBits> u, std::span<Scattered> out) const {
  const InPhase sampling(Phase::sample);
  return scattering().sample_n(wo, place(), u, out);
}

std::optional<Scattered> PathVertex::sample_adjoint(PathBits& u) const {
  const InPhase sampling(Phase::sample);
  return scattering().sample_adjoint(wo, place(), u);
}

World::World(const Scene& s) : scene(s), embree(s), lights(s) {
  for (const Vertex& v : scene.vertices) extent = std::max(extent, largest(v.at));
  for (const Sphere& sphere : scene.spheres) extent = std::max(extent, float(sphere.radius));
  for (const Cylinder& c : scene.cylinders) {
    const auto reach = [&](Vec3<double> v) { return float(length(v)); };
    extent = std::max(extent, reach(c.base) + reach(c.axis) + reach(c.s));
  }
  for (const auto* all : {&scene.rectangles, &scene.disks}) {
    for (const Flat& f : *all) {
      for (const double x : {-1., 1.})
        extent = std::max({extent, largest(point_on(f, x, -1)), largest(point_on(f, x, 1))});
    }
  }
}

std::optional<Hit> World::past_lamps(const Ray& ray, std::optional<Hit> hit) const {
  if (!scene.hide_lamps) return hit;
  for (int i = 0; hit && i < 1000 && scene.surfaces[surface_of(scene, *hit)].radiance != Rgb{}; ++i) {
    const float beyond = hit->distance + near(ray.origin + hit->distance * ray.direction);
    hit = embree.intersect(
        {ray.origin, ray.direction, std::max(beyond, std::nextafter(hit->distance, ray.far)), ray.far});
  }
  return hit;
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
