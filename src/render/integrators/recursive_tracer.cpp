// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/integrators/recursive_tracer.hpp"

#include <algorithm>
#include <array>

#include "reflectree/error.hpp"

namespace reflectree::render {

namespace {
float largest(Rgb c) { return std::max({c.r, c.g, c.b}); }
}  // namespace

RecursiveTracer::RecursiveTracer(const Scene& scene, Technique technique, int split, int max_depth)
    : world_(scene), technique_(technique), split_(std::size_t(split)), max_depth_(max_depth) {
  if (split < 1 || split_ > max_split)
    throw Error("cannot split into " + std::to_string(split), "--split", "choose 1 to 64");
}

Rgb RecursiveTracer::radiance(Point origin, Direction direction, PathBits& u) const {
  return arriving({origin, direction, {1, 1, 1}, 0, 1, split_}, u);
}

Rgb RecursiveTracer::arriving(const Ray& ray, PathBits& u) const {
  if (max_depth_ >= 0 && ray.depth > max_depth_) return {};
  const auto share = [&](float other) {
    if (!(ray.drawn_pdf > 0)) return 1.f;
    return technique_ == Technique::light ? 0.f : heuristic(technique_, ray.drawn_pdf, other);
  };
  const auto hit = ray.depth == 1
                       ? world_.seen(world_.camera_ray(ray.origin, ray.direction))
                       : world_.embree.intersect({ray.origin, ray.direction, world_.near(ray.origin)});
  if (!hit) {
    if (!world_.scene.environment) return {};
    if (ray.depth == 1) return world_.backdrop(ray.direction);
    const auto [radiance, other] = world_.lights.environment(ray.direction);
    return share(other) * radiance;
  }
  const PathVertex at(world_.scene, *hit, ray.origin, ray.direction);
  Rgb result = at.emitted();
  if (result != Rgb{} && ray.drawn_pdf > 0)
    result = share(world_.lights.pdf(ray.origin, ray.direction, *hit, at.on)) * result;
  if (ray.depth == max_depth_) return result;
  if (ray.split > 1 && !at.scattering().only_delta()) return result + leaving_split(at, ray, u);
  Scattered next;
  return result + leaving(at, ray, {&u, 1}, {&next, 1});
}

// Apart from `arriving`, whose frames would otherwise carry these arrays down unsplit paths.
[[gnu::noinline]] Rgb RecursiveTracer::leaving_split(const PathVertex& at, const Ray& ray,
                                                     PathBits& u) const {
  std::array<Scattered, max_split> next;
  std::array<PathBits, max_split> branches;
  for (std::uint32_t k = 0; k < ray.split; ++k) branches[k] = u.branch(k, std::uint32_t(ray.split));
  return leaving(at, ray, std::span(branches).first(ray.split), std::span(next).first(ray.split));
}

// The mean over u.size() branches.
Rgb RecursiveTracer::leaving(const PathVertex& at, const Ray& ray, std::span<PathBits> u,
                             std::span<Scattered> next) const {
  const Scattering& scattering = at.scattering();
  const bool competes = scattering.has_pdf() && technique_ != Technique::surface;
  Rgb sum;
  for (PathBits& bits : u) {
    if (technique_ != Technique::surface) {
      bits.begin(ray.depth, Decision::light);
      sum = sum + world_.direct(at, technique_, bits);
    }
    bits.begin(ray.depth, Decision::surface);
  }
  const std::size_t filled = at.sample_n(u, next);
  const std::size_t split = scattering.only_delta() ? ray.split : std::max<std::size_t>(1, ray.split / 4);
  for (std::size_t i = 0; i < filled; ++i) {
    Rgb weight = next[i].weight;
    if (!(largest(weight) > 0)) continue;
    const Rgb throughput = ray.throughput * weight;
    if (u.size() == 1 && ray.depth >= world_.scene.rr_depth) {
      u[i].begin(ray.depth, Decision::survival);
      const float survive = std::min(.95f, largest(throughput));
      if (!(to_unit_float(u[i]()) < survive)) continue;
      weight = (1 / survive) * weight;
    }
    const float pdf = competes && !next[i].delta ? next[i].pdf : 0;
    const Direction direction = normalize(to_world(at.frame, next[i].wi));
    sum = sum + weight * arriving({at.on.at, direction, throughput, pdf, ray.depth + 1, split}, u[i]);
  }
  return (1 / float(u.size())) * sum;
}

}  // namespace reflectree::render
