// SPDX-License-Identifier: Apache-2.0
// Photons' paths: from a source through the scene. Surfaces scatter by the adjoint of their function.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/render/integrators/photon_mapper.hpp"

namespace reflectree::render {

namespace {

constexpr std::size_t batch = 1024;
constexpr int longest_path = 65535;

float largest(Rgb c) { return std::max({c.r, c.g, c.b}); }

void trace(const World& world, const Emission& emission, float share, PathBits& u, std::vector<Photon>& out) {
  const auto start = emission.sample(u);
  if (!start) return;
  Point origin = start->at;
  Direction direction = start->direction;
  Rgb power = share * start->power;
  const int most = world.scene.max_depth < 0 ? longest_path : world.scene.max_depth - 1;
  bool deltas = true;
  for (int edges = 1; edges <= most; ++edges) {
    const auto hit =
        world.embree.intersect({origin, direction, edges > 1 || start->inside ? world.near(origin) : 0});
    if (!hit) return;
    const PathVertex at(world.scene, *hit, origin, direction);
    const float cosine = std::abs(dot(at.on.normal(), direction));
    if (!at.scattering().only_delta() && cosine > 1e-6f)
      out.push_back({at.on.at, -direction, (1 / cosine) * power, std::uint16_t(edges), edges > 1 && deltas});
    u.begin(edges, Decision::surface);
    const auto next = at.sample_adjoint(u);
    if (!next) return;
    direction = normalize(to_world(at.frame, next->wi));
    // Where shading and true normals differ, |cos_s wi cos_g wo / (cos_g wi cos_s wo)| keeps to what a path
    // from the camera finds (Veach 1997, 5.3.2); here at.wo is where light comes from.
    const float turned = std::abs(at.wo.z * dot(at.on.normal(), direction)),
                over = std::abs(next->wi.z) * cosine;
    if (!(over > 0)) return;
    const Rgb weight = (turned / over) * next->weight;
    deltas = deltas && next->delta;
    // Roulette by what is left of the largest channel keeps powers alike.
    const float survive = std::min(.95f, largest(power * weight) / largest(power));
    u.begin(edges, Decision::survival);
    if (!(to_unit_float(u()) < survive)) return;
    power = (1 / survive) * (power * weight);
    origin = at.on.at;
  }
}

}  // namespace

// In batches, each into its own vector: the order does not depend on threads.
std::vector<Photon> trace_photons(const World& world, const Emission& emission, std::size_t count,
                                  std::uint64_t seed, int sample, const Host& host) {
  std::vector<std::vector<Photon>> parts((count + batch - 1) / batch);
  std::atomic<bool> stopped = false;
  host.parallel_for(parts.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !stopped; ++i) {
      if (host.cancelled()) stopped = true;
      for (std::size_t k = i * batch; k < std::min(count, (i + 1) * batch); ++k) {
        // Each pass is a point set of its own, apart from the pixels'.
        PathBits u(world.scene.points, ~seed, std::uint64_t(sample), std::uint32_t(k));
        trace(world, emission, 1 / float(count), u, parts[i]);
      }
    }
  });
  if (stopped) throw Cancelled();
  std::vector<Photon> photons;
  for (const auto& part : parts) photons.insert(photons.end(), part.begin(), part.end());
  return photons;
}

}  // namespace reflectree::render
