// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/path_tracer.hpp"

#include <algorithm>
#include <cmath>

namespace reflectree::render {

namespace {

float largest(Point p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }
float largest(Rgb c) { return std::max({c.r, c.g, c.b}); }

}  // namespace

PathTracer::PathTracer(const Scene& scene, Technique technique)
    : scene_(scene), technique_(technique), embree_(scene), lights_(scene) {
  for (const Vertex& v : scene.vertices) extent_ = std::max(extent_, largest(v.at));
  for (const Sphere& s : scene.spheres) extent_ = std::max(extent_, float(s.radius));
}

// How far from a surface rays start: well above the rounding of its coordinates.
float PathTracer::near(Point at) const { return 5e-5f * std::max(largest(at), .01f * extent_); }

// Of a technique with density `own` against the one with `other`.
float PathTracer::weight(float own, float other) const {
  if (technique_ != Technique::power) return own / (own + other);
  const float ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

// Next-event estimation: a point on a light, weighed against the directions that the surface would draw.
Rgb PathTracer::direct(const Interaction& on, const Frame<float>& frame, Direction wo,
                       const Scattering& surface, Pcg32& u) const {
  const auto light = lights_.sample(on.at, u);
  if (!light || !(light->pdf > 0)) return {};
  const Direction wi = to_local(frame, light->direction);
  const Rgb f_cos = surface.f_cos(wo, wi, on.uv);
  const Rgb arriving = f_cos * light->radiance;
  if (arriving == Rgb{}) return {};
  const float start = near(on.at);
  const float end = std::isinf(light->distance) ? light->distance : light->distance * (1 - 1e-4f) - start;
  if (embree_.occluded(on.at, light->direction, start, end)) return {};
  const bool alone = light->delta || technique_ == Technique::light;
  const float share = alone ? 1 : weight(light->pdf, surface.pdf(wo, wi, on.uv));
  return (share / light->pdf) * arriving;
}

// `depth` counts edges: 1 is what the camera sees directly.
Rgb PathTracer::radiance(Point origin, Direction direction, Pcg32& u) const {
  Rgb result, throughput{1, 1, 1};
  float drawn_pdf = 0;  // of the direction; 0: nothing competes with it
  const auto share = [&](float other) {
    if (!(drawn_pdf > 0)) return 1.f;
    return technique_ == Technique::light ? 0.f : weight(drawn_pdf, other);
  };
  for (int depth = 1; scene_.max_depth < 0 || depth <= scene_.max_depth; ++depth) {
    const auto hit = embree_.intersect(origin, direction, depth == 1 ? 0 : near(origin));
    if (!hit) {
      if (!scene_.environment) return result;
      const float other = drawn_pdf > 0 ? lights_.pdf_of_environment(direction) : 0;
      return result + share(other) * (throughput * scene_.environment->radiance(direction));
    }
    const Interaction on = interaction_at(scene_, *hit, origin, direction);
    const Surface& surface = scene_.surfaces[on.surface];
    if (surface.radiance != Rgb{} && dot(on.shading, direction) < 0) {
      const float other = drawn_pdf > 0 ? lights_.pdf(origin, direction, *hit, on) : 0;
      result = result + share(other) * (throughput * surface.radiance);
    }
    if (depth == scene_.max_depth) return result;
    const Scattering& scattering = *surface.scattering;
    const Frame<float> frame = frame_from_normal(on.shading);
    const Direction wo = to_local(frame, -direction);
    const bool competes = scattering.has_pdf() && technique_ != Technique::surface;
    if (competes) result = result + throughput * direct(on, frame, wo, scattering, u);
    const auto next = scattering.sample(wo, on.uv, u);
    if (!next) return result;
    throughput = throughput * next->weight;
    drawn_pdf = competes && !next->delta ? next->pdf : 0;
    origin = on.at, direction = normalize(to_world(frame, next->wi));
    if (!(largest(throughput) > 0)) return result;
    if (depth >= scene_.rr_depth) {  // Russian roulette by the largest channel
      const float survive = std::min(.95f, largest(throughput));
      if (!(to_unit_float(u()) < survive)) return result;
      throughput = (1 / survive) * throughput;
    }
  }
  return result;
}

}  // namespace reflectree::render
