// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/integrators/photon_mapper.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reflectree/error.hpp"

namespace reflectree::render {

namespace {

float largest(Rgb c) { return std::max({c.r, c.g, c.b}); }

// Each path leaves some photons of 40 bytes.
constexpr std::size_t usual_count = std::size_t(1) << 20U, largest_count = std::size_t(1) << 26U;

// Four pixels at the median distance of what the camera sees through a grid of its pixels.
float radius_for(const World& world) {
  const Scene& scene = world.scene;
  const Camera& c = scene.camera;
  std::vector<float> distances;
  for (int i = 0; i < 256; ++i) {
    const CameraLine line = line_through(c, (float(i % 16) + .5f) / 16, (float(i / 16) + .5f) / 16);
    if (const auto hit = world.embree.intersect({line.origin, line.direction}))
      distances.push_back(hit->distance);
  }
  if (distances.empty()) return 1;
  std::nth_element(distances.begin(), distances.begin() + std::ptrdiff_t(distances.size() / 2),
                   distances.end());
  const float away = c.parallel ? length(c.left) : distances[distances.size() / 2];
  return 4 * away * 2 * c.tan_x / float(scene.width);
}

}  // namespace

PhotonMapper::PhotonMapper(const Scene& scene, Technique technique)
    : world_(scene),
      technique_(technique),
      emission_(scene),
      options_(scene.transport.photons),
      count_(options_.count > 0
                 ? std::size_t(options_.count)
                 : std::min(std::size_t(scene.width) * std::size_t(scene.height), usual_count)),
      split_(std::uint32_t(scene.transport.split > 0 ? scene.transport.split : 4)),
      first_radius_(options_.radius) {
  if (split_ > max_split) throw Error("too many directions", "--split", "choose 1 to 64");
  if (options_.count < 0 || count_ > largest_count)
    throw Error("too many photons", "--photons", "choose at most 67108864 per pass; passes add up");
  if (!(options_.shrink > 0 && options_.shrink <= 1))
    throw Error("photons' shrink is not in (0, 1]", "the integrator", "2/3 is usual, 1 keeps the radius");
  if (!(first_radius_ >= 0) || !std::isfinite(first_radius_))
    throw Error("photons' radius is negative", "the integrator", "give a length, or 0 for a few pixels");
  if (first_radius_ == 0)
    first_radius_ = std::min(radius_for(world_), emission_.reach() > 0 ? .05f * emission_.reach() : 1.f);
}

float PhotonMapper::radius(int sample) const {
  double square = double(first_radius_) * double(first_radius_);
  for (int i = 1; i <= sample; ++i) square *= (i + double(options_.shrink)) / (i + 1);
  return float(std::sqrt(square));
}

void PhotonMapper::prepare(int sample, std::uint64_t seed, const Host& host) {
  std::vector<Photon> photons = trace_photons(world_, emission_, count_, seed, sample, host), caustic;
  std::copy_if(photons.begin(), photons.end(), std::back_inserter(caustic),
               [](const Photon& p) { return p.caustic; });
  const float r = radius(sample);
  maps_ = {PhotonMap(std::move(photons), r), PhotonMap(std::move(caustic), r)};
}

// Edges of a photon's path where the camera's has `depth`.
int PhotonMapper::edges_left(int depth) const {
  return world_.scene.max_depth < 0 ? std::numeric_limits<int>::max() : world_.scene.max_depth - depth;
}

Rgb PhotonMapper::radiance(Point origin, Direction direction, PathBits& u) const {
  return follow(origin, direction, 1, split_, u);
}

// The camera's path, through deltas. Where a surface has both parts, the delta's branches split no more.
Rgb PhotonMapper::follow(Point origin, Direction direction, int depth, std::uint32_t split,
                         PathBits& u) const {
  Rgb result, throughput{1, 1, 1};
  for (; edges_left(depth) >= 0; ++depth) {
    const auto hit = depth == 1 ? world_.seen(world_.camera_ray(origin, direction))
                                : world_.embree.intersect({origin, direction, world_.near(origin)});
    if (!hit && depth == 1) return world_.backdrop(direction);
    if (!hit) {
      if (world_.scene.environment)
        result = result + throughput * world_.scene.environment->radiance(direction);
      return result;
    }
    const PathVertex at(world_.scene, *hit, origin, direction);
    result = result + throughput * at.emitted();
    if (edges_left(depth) == 0) return result;
    if (!at.scattering().only_delta()) return result + throughput * leaving(at, depth, split, u);
    u.begin(depth, Decision::surface);
    const auto next = at.sample(u);
    if (!next) return result;
    throughput = throughput * next->weight;
    if (depth >= world_.scene.rr_depth) {
      const float survive = std::min(.95f, largest(throughput));
      u.begin(depth, Decision::survival);
      if (!(to_unit_float(u()) < survive)) return result;
      throughput = (1 / survive) * throughput;
    }
    origin = at.on.at, direction = normalize(to_world(at.frame, next->wi));
  }
  return result;
}

Rgb PhotonMapper::leaving(const PathVertex& at, int depth, std::uint32_t split, PathBits& u) const {
  const bool competes = at.scattering().has_pdf();
  const std::uint32_t n = options_.gather ? split : 1;
  std::array<PathBits, max_split> branches;
  std::array<Scattered, max_split> next;
  Rgb sum;
  for (std::uint32_t k = 0; k < n; ++k) {
    branches[k] = n > 1 ? u.branch(k, n) : u;
    branches[k].begin(depth, Decision::light);
    sum = sum + world_.direct(at, technique_, branches[k]);
    branches[k].begin(depth, Decision::surface);
  }
  const std::size_t filled = at.sample_n(std::span(branches).first(n), std::span(next).first(n));
  for (std::size_t i = 0; i < filled; ++i)
    sum = sum + next[i].weight * beyond(at, next[i], depth + 1, competes, branches[i]);
  const int edges = edges_left(depth);
  const Rgb looked_up =
      options_.gather ? maps_.caustic.reflected(at, 2, edges) : maps_.all.reflected(at, 2, edges);
  return looked_up + (1 / float(n)) * sum;
}

// What arrives by a direction of the surface's own: straight from a light, and what is gathered. The delta
// part of a surface goes on as the camera's path.
Rgb PhotonMapper::beyond(const PathVertex& at, const Scattered& next, int depth, bool competes,
                         PathBits& u) const {
  const Direction direction = normalize(to_world(at.frame, next.wi));
  if (next.delta) {
    if (depth <= world_.scene.rr_depth) return follow(at.on.at, direction, depth, 1, u);
    const float survive = std::min(.95f, largest(next.weight));
    u.begin(depth - 1, Decision::survival);
    return to_unit_float(u()) < survive ? (1 / survive) * follow(at.on.at, direction, depth, 1, u) : Rgb{};
  }
  const auto share = [&](float other) { return competes ? heuristic(technique_, next.pdf, other) : 1.f; };
  const auto hit = world_.embree.intersect({at.on.at, direction, world_.near(at.on.at)});
  if (!hit) {
    if (!world_.scene.environment) return {};
    const auto [radiance, other] = world_.lights.environment(direction);
    return share(other) * radiance;
  }
  const PathVertex y(world_.scene, *hit, at.on.at, direction);
  Rgb result = y.emitted();
  if (result != Rgb{}) result = share(world_.lights.pdf(at.on.at, direction, *hit, y.on)) * result;
  return options_.gather ? result + gathered(y, depth, u) : result;
}

// Light that `at` sends back, from the map there and beyond its deltas. Lights that deltas show are caustics.
Rgb PhotonMapper::gathered(PathVertex at, int depth, PathBits& u) const {
  Rgb result, throughput{1, 1, 1};
  for (;; ++depth) {
    const int edges = edges_left(depth);
    if (edges <= 0) return result;
    const Scattering& scattering = at.scattering();
    if (!scattering.only_delta()) result = result + throughput * maps_.all.reflected(at, 1, edges);
    if (scattering.lobes() == Lobes::finite) return result;
    u.begin(depth, Decision::surface);
    const auto next = at.sample(u);
    if (!next || !next->delta) return result;
    throughput = throughput * next->weight;
    const float survive = std::min(.95f, largest(throughput));
    u.begin(depth, Decision::survival);
    if (!(to_unit_float(u()) < survive)) return result;
    throughput = (1 / survive) * throughput;
    const Point origin = at.on.at;
    const Direction direction = normalize(to_world(at.frame, next->wi));
    const auto hit = world_.embree.intersect({origin, direction, world_.near(origin)});
    if (!hit) return result;
    at = PathVertex(world_.scene, *hit, origin, direction);
  }
}

}  // namespace reflectree::render
