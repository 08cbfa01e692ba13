// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/path_tracer.hpp"

#include <algorithm>

namespace reflectree::render {

namespace {
float largest(Rgb c) { return std::max({c.r, c.g, c.b}); }
}  // namespace

// `depth` counts edges: 1 is what the camera sees directly.
Rgb PathTracer::radiance(Point origin, Direction direction, PathBits& u) const {
  const Scene& scene = world_.scene;
  Rgb result, throughput{1, 1, 1};
  float drawn_pdf = 0;  // of the direction; 0: nothing competes with it
  const auto share = [&](float other) {
    if (!(drawn_pdf > 0)) return 1.f;
    return technique_ == Technique::light ? 0.f : heuristic(technique_, drawn_pdf, other);
  };
  for (int depth = 1; scene.max_depth < 0 || depth <= scene.max_depth; ++depth) {
    const auto hit = world_.embree.intersect(origin, direction, depth == 1 ? 0 : world_.near(origin));
    if (!hit) {
      if (!scene.environment) return result;
      const auto [radiance, other] = world_.lights.environment(direction);
      return result + share(other) * (throughput * radiance);
    }
    const PathVertex at(scene, *hit, origin, direction);
    if (const Rgb emitted = at.emitted(); emitted != Rgb{}) {
      const float other = drawn_pdf > 0 ? world_.lights.pdf(origin, direction, *hit, at.on) : 0;
      result = result + share(other) * (throughput * emitted);
    }
    if (depth == scene.max_depth) return result;
    const Scattering& scattering = at.scattering();
    const bool competes = scattering.has_pdf() && technique_ != Technique::surface;
    if (technique_ != Technique::surface) {
      u.begin(depth, Decision::light);
      result = result + throughput * world_.direct(at, technique_, u);
    }
    u.begin(depth, Decision::surface);
    const auto next = at.sample(u);
    if (!next) return result;
    throughput = throughput * next->weight;
    drawn_pdf = competes && !next->delta ? next->pdf : 0;
    origin = at.on.at, direction = to_world(at.frame, next->wi);
    if (!(largest(throughput) > 0)) return result;
    if (depth >= scene.rr_depth) {  // Russian roulette by the largest channel
      u.begin(depth, Decision::survival);
      const float survive = std::min(.95f, largest(throughput));
      if (!(to_unit_float(u()) < survive)) return result;
      throughput = (1 / survive) * throughput;
    }
  }
  return result;
}

}  // namespace reflectree::render
