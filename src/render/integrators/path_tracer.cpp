// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/integrators/path_tracer.hpp"

#include <algorithm>
#include <map>

#include "reflectree/render/integrators/profile.hpp"

namespace reflectree::render {

namespace {

float largest(Rgb c) { return std::max({c.r, c.g, c.b}); }

// One that is on its way.
struct Path {
  PathBits* bits;
  Rgb* result;
  Rgb throughput{1, 1, 1};
  float drawn_pdf = 0;  // of the ray's direction; 0: nothing competes with it
};

// What a light at a vertex brings if nothing stands between.
struct Expected {
  Rgb* result;
  Rgb radiance;
};

}  // namespace

// Paths under way, each with its ray; and those that have met a surface, in the order of materials, each with
// its vertex and what is asked there. All are kept for the next bounce.
struct PathTracer::Wave {
  std::vector<Path> paths, met;
  std::vector<Ray> rays, shadow_rays;
  std::vector<std::optional<Hit>> hits;
  std::vector<Direction> escaped, wi;
  std::vector<Environment::Light> sky;
  std::vector<std::uint32_t> groups, order, starts;  // groups: of what the hits are on
  std::vector<PathVertex> vertices;
  std::vector<Scattering::View> views;
  std::vector<Point> points;
  std::vector<PathBits*> bits;
  std::vector<std::optional<LightSample>> lights;
  std::vector<Scattering::Value> values;
  std::vector<std::optional<Scattered>> next;
  std::vector<Expected> expected;
  std::vector<std::uint8_t> dark;

  template <class Visit>
  void each_material(const Visit& visit) const {
    for (std::size_t begin = 0, end; begin < vertices.size(); begin = end) {
      const Scattering& scattering = vertices[begin].scattering();
      for (end = begin + 1; end < vertices.size() && &vertices[end].scattering() == &scattering;) ++end;
      visit(scattering, begin, end - begin);
    }
  }
};

PathTracer::PathTracer(const Scene& scene, Technique technique) : world_(scene), technique_(technique) {
  std::map<const Scattering*, std::uint32_t> known;
  for (const Surface& s : scene.surfaces)
    group_.push_back(known.emplace(s.scattering.get(), std::uint32_t(known.size())).first->second);
  groups_ = known.size();
}

void PathTracer::radiance(std::span<CameraRay> rays, std::span<Rgb> out) const {
  Wave wave;
  std::fill_n(out.begin(), rays.size(), Rgb{});
  wave.paths.reserve(rays.size()), wave.rays.reserve(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    wave.paths.push_back({&rays[i].bits, &out[i]});
    wave.rays.push_back(world_.camera_ray(rays[i].origin, rays[i].direction));
  }
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
  wave.hits.resize(n);
  world_.embree.intersect(wave.rays, depth == 1, wave.hits);
  const bool hides = depth == 1 && scene.hide_lamps, sky = scene.environment && !hides;
  if (hides) {
    for (std::size_t i = 0; i < n; ++i) wave.hits[i] = world_.past_lamps(wave.rays[i], wave.hits[i]);
  }
  wave.starts.assign(groups_ + 1, 0);
  const auto add = [&](const Path& p, Rgb radiance, float other) {
    float share = 1;
    if (p.drawn_pdf > 0)
      share = technique_ == Technique::light ? 0 : heuristic(technique_, p.drawn_pdf, other);
    *p.result = *p.result + share * (p.throughput * radiance);
  };
  wave.escaped.clear(), wave.groups.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (wave.hits[i]) {
      ++wave.starts[(wave.groups[i] = group_[surface_of(scene, *wave.hits[i])]) + 1];
    } else if (sky) {
      wave.escaped.push_back(wave.rays[i].direction);
    }
  }
  if (sky) {
    wave.sky.resize(wave.escaped.size());
    world_.lights.environment(wave.escaped, wave.sky);
    auto light = wave.sky.begin();
    for (std::size_t i = 0; i < n; ++i) {
      if (!wave.hits[i]) add(wave.paths[i], light->radiance, light->pdf), ++light;
    }
  }
  for (std::size_t g = 0; g < groups_; ++g) wave.starts[g + 1] += wave.starts[g];
  wave.order.resize(wave.starts[groups_]);
  for (std::size_t i = 0; i < n; ++i) {
    if (wave.hits[i]) wave.order[wave.starts[wave.groups[i]]++] = std::uint32_t(i);
  }
  const std::size_t met = wave.order.size();
  wave.met.resize(met), wave.views.resize(met), wave.points.resize(met), wave.bits.resize(met);
  wave.vertices.clear(), wave.vertices.reserve(met);  // views point into them
  for (std::size_t k = 0; k < met; ++k) {
    const std::uint32_t i = wave.order[k];
    const Path& p = wave.met[k] = wave.paths[i];
    const Ray& ray = wave.rays[i];
    const PathVertex& at = wave.vertices.emplace_back(scene, *wave.hits[i], ray.origin, ray.direction);
    wave.views[k] = {at.wo, at.place()}, wave.points[k] = at.on.at, wave.bits[k] = p.bits;
    if (const Rgb emitted = at.emitted(); emitted != Rgb{}) {
      const bool competes = p.drawn_pdf > 0;
      add(p, emitted, competes ? world_.lights.pdf(ray.origin, ray.direction, *wave.hits[i], at.on) : 0);
    }
  }
}

// Next-event estimation at every vertex.
void PathTracer::light(Wave& wave, int depth) const {
  const std::size_t n = wave.met.size();
  for (PathBits* bits : wave.bits) bits->begin(depth, Decision::light);
  wave.lights.resize(n), wave.wi.resize(n), wave.values.resize(n);
  world_.lights.sample(wave.points, wave.bits, wave.lights);
  for (std::size_t i = 0; i < n; ++i)
    wave.wi[i] = wave.lights[i] ? to_local(wave.vertices[i].frame, wave.lights[i]->direction) : Direction{};
  {
    const InPhase evaluating(Phase::eval);
    wave.each_material([&](const Scattering& scattering, std::size_t begin, std::size_t count) {
      scattering.values(std::span(wave.views).subspan(begin, count), std::span(wave.wi).subspan(begin, count),
                        std::span(wave.values).subspan(begin, count));
    });
  }
  wave.shadow_rays.resize(n), wave.expected.resize(n);
  std::size_t shadows = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto& light = wave.lights[i];
    if (!light || !competes(*light, wave.vertices[i].scattering())) continue;
    const Rgb lit = World::unshadowed(*light, wave.values[i], technique_);
    if (lit == Rgb{}) continue;
    wave.shadow_rays[shadows] = world_.shadow_ray(wave.points[i], light->direction, light->distance);
    wave.expected[shadows++] = {wave.met[i].result, wave.met[i].throughput * lit};
  }
  wave.shadow_rays.resize(shadows), wave.expected.resize(shadows);
  wave.dark.resize(wave.shadow_rays.size());
  world_.embree.occluded(wave.shadow_rays, wave.dark);
  for (std::size_t i = 0; i < wave.expected.size(); ++i) {
    if (!wave.dark[i]) *wave.expected[i].result = *wave.expected[i].result + wave.expected[i].radiance;
  }
}

// Draws where paths go on; those that do are the wave's.
void PathTracer::scatter(Wave& wave, int depth) const {
  for (PathBits* bits : wave.bits) bits->begin(depth, Decision::surface);
  wave.next.resize(wave.met.size());
  {
    const InPhase sampling(Phase::sample);
    wave.each_material([&](const Scattering& scattering, std::size_t begin, std::size_t count) {
      scattering.samples(std::span(wave.views).subspan(begin, count),
                         std::span(wave.bits).subspan(begin, count),
                         std::span(wave.next).subspan(begin, count));
    });
  }
  wave.paths.clear(), wave.rays.clear();
  for (std::size_t i = 0; i < wave.met.size(); ++i) {
    const Path& p = wave.met[i];
    const PathVertex& at = wave.vertices[i];
    const auto& next = wave.next[i];
    if (!next) continue;
    Rgb throughput = p.throughput * next->weight;
    const float brightest = largest(throughput);
    if (!(brightest > 0)) continue;
    if (depth >= world_.scene.rr_depth) {  // Russian roulette by the largest channel
      p.bits->begin(depth, Decision::survival);
      const float survive = std::min(.95f, brightest);
      if (!(to_unit_float((*p.bits)()) < survive)) continue;
      throughput = (1 / survive) * throughput;
    }
    const bool competes = at.scattering().has_pdf() && technique_ != Technique::surface;
    wave.paths.push_back({p.bits, p.result, throughput, competes && !next->delta ? next->pdf : 0});
    wave.rays.push_back({at.on.at, to_world(at.frame, next->wi), world_.near(at.on.at)});
  }
}

}  // namespace reflectree::render
