// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/path_tracer.hpp"

#include <algorithm>
#include <map>

#include "reflectree/render/profile.hpp"

namespace reflectree::render {

namespace {

float largest(Rgb c) { return std::max({c.r, c.g, c.b}); }

// One that is on its way.
struct Path {
  PathBits* bits;
  Rgb* result;
  Ray ray;
  Rgb throughput{1, 1, 1};
  float drawn_pdf = 0;  // of the ray's direction; 0: nothing competes with it
};

// What lights at a vertex bring if nothing stands between.
struct Expected {
  Rgb* result;
  Rgb radiance;
};

}  // namespace

// Paths that have met a surface stand in the order of materials, each with its vertex.
struct PathTracer::Wave {
  std::vector<Path> paths, met;
  std::vector<Ray> rays;
  std::vector<std::optional<Hit>> hits;
  std::vector<Interaction> on;
  std::vector<std::uint32_t> order, starts;
  std::vector<PathVertex> vertices;
  std::vector<Expected> expected;
  std::vector<std::uint8_t> dark;

  template <class Visit>
  void each_material(const Visit& visit) const {
    for (std::size_t begin = 0, end; begin < vertices.size(); begin = end) {
      const Scattering& scattering = vertices[begin].scattering();
      for (end = begin + 1; end < vertices.size() && &vertices[end].scattering() == &scattering;) ++end;
      visit(scattering, begin, end);
    }
  }
};

PathTracer::PathTracer(const Scene& scene, Technique technique) : world_(scene), technique_(technique) {
  std::map<const Scattering*, std::uint32_t> known;
  for (const Surface& s : scene.surfaces)
    group_.push_back(known.emplace(s.scattering.get(), std::uint32_t(known.size())).first->second);
  groups_ = known.size();
}

void PathTracer::radiance(std::span<Sight> sights, std::span<Rgb> out) const {
  Wave wave;
  std::fill_n(out.begin(), sights.size(), Rgb{});
  for (std::size_t i = 0; i < sights.size(); ++i)
    wave.paths.push_back({&sights[i].bits, &out[i], {sights[i].origin, sights[i].direction}});
  // `depth` counts edges: 1 is what the camera sees directly.
  const int last = world_.scene.max_depth;
  for (int depth = 1; !wave.paths.empty() && (last < 0 || depth <= last); ++depth) {
    meet(wave, depth);
    if (depth == last) return;
    if (technique_ != Technique::surface) light(wave, depth);
    scatter(wave, depth);
  }
}

// Traces all paths; adds the light that they meet. Those that met a surface move on to `met`.
void PathTracer::meet(Wave& wave, int depth) const {
  const Scene& scene = world_.scene;
  const std::size_t n = wave.paths.size();
  wave.rays.clear();
  for (const Path& p : wave.paths) wave.rays.push_back(p.ray);
  wave.hits.resize(n), wave.on.resize(n);
  world_.embree.intersect(wave.rays, depth == 1, wave.hits);
  wave.starts.assign(groups_ + 1, 0);
  const auto add = [&](const Path& p, Rgb radiance, float other) {
    float share = 1;
    if (p.drawn_pdf > 0)
      share = technique_ == Technique::light ? 0 : heuristic(technique_, p.drawn_pdf, other);
    *p.result = *p.result + share * (p.throughput * radiance);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Path& p = wave.paths[i];
    if (!wave.hits[i]) {
      if (!scene.environment) continue;
      const auto [radiance, other] = world_.lights.environment(p.ray.direction);
      add(p, radiance, other);
      continue;
    }
    wave.on[i] = interaction_at(scene, *wave.hits[i], p.ray.origin, p.ray.direction);
    ++wave.starts[group_[wave.on[i].surface] + 1];
  }
  for (std::size_t g = 0; g < groups_; ++g) wave.starts[g + 1] += wave.starts[g];
  wave.order.resize(wave.starts[groups_]);
  for (std::size_t i = 0; i < n; ++i) {
    if (wave.hits[i]) wave.order[wave.starts[group_[wave.on[i].surface]]++] = std::uint32_t(i);
  }
  wave.met.clear(), wave.vertices.clear();
  for (const std::uint32_t i : wave.order) {
    const Path& p = wave.met.emplace_back(wave.paths[i]);
    const PathVertex& at = wave.vertices.emplace_back(scene, wave.on[i], p.ray.direction);
    if (const Rgb emitted = at.emitted(); emitted != Rgb{}) {
      const bool competes = p.drawn_pdf > 0;
      add(p, emitted,
          competes ? world_.lights.pdf(p.ray.origin, p.ray.direction, *wave.hits[i], at.on) : 0);
    }
  }
}

// Next-event estimation at every vertex.
void PathTracer::light(Wave& wave, int depth) const {
  wave.rays.clear(), wave.expected.clear();
  for (std::size_t i = 0; i < wave.met.size(); ++i) {
    const Path& p = wave.met[i];
    p.bits->begin(depth, Decision::light);
    const Lit lit = world_.unshadowed(wave.vertices[i], technique_, *p.bits);
    if (lit.radiance == Rgb{}) continue;
    wave.rays.push_back(lit.towards);
    wave.expected.push_back({p.result, p.throughput * lit.radiance});
  }
  wave.dark.resize(wave.rays.size());
  world_.embree.occluded(wave.rays, wave.dark);
  for (std::size_t i = 0; i < wave.expected.size(); ++i) {
    if (!wave.dark[i]) *wave.expected[i].result = *wave.expected[i].result + wave.expected[i].radiance;
  }
}

// Draws where paths go on; those that do are the wave's.
void PathTracer::scatter(Wave& wave, int depth) const {
  wave.paths.clear();
  for (std::size_t i = 0; i < wave.met.size(); ++i) {
    Path& p = wave.met[i];
    const PathVertex& at = wave.vertices[i];
    p.bits->begin(depth, Decision::surface);
    const auto next = at.sample(*p.bits);
    if (!next) continue;
    p.throughput = p.throughput * next->weight;
    const float brightest = largest(p.throughput);
    if (!(brightest > 0)) continue;
    if (depth >= world_.scene.rr_depth) {  // Russian roulette by the largest channel
      p.bits->begin(depth, Decision::survival);
      const float survive = std::min(.95f, brightest);
      if (!(to_unit_float((*p.bits)()) < survive)) continue;
      p.throughput = (1 / survive) * p.throughput;
    }
    const bool competes = at.scattering().has_pdf() && technique_ != Technique::surface;
    p.drawn_pdf = competes && !next->delta ? next->pdf : 0;
    p.ray = {at.on.at, to_world(at.frame, next->wi), world_.near(at.on.at)};
    wave.paths.push_back(p);
  }
}

}  // namespace reflectree::render
