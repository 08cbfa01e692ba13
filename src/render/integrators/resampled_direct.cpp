// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/integrators/resampled_direct.hpp"

#include <array>
#include <limits>

#include "reflectree/brdf/target.hpp"
#include "reflectree/error.hpp"

namespace reflectree::render {

namespace {

// The shapes that shine, alone; vertices are kept with their indices.
Scene lamps_of(const Scene& scene) {
  const auto shines = [&](const auto& shape) { return scene.surfaces[shape.surface].radiance != Rgb{}; };
  Scene lamps;
  lamps.surfaces = scene.surfaces;
  for (const Triangle& t : scene.triangles) {
    if (!shines(t)) continue;
    Triangle own{{}, t.surface};
    for (std::size_t k = 0; k < 3; ++k) {
      own.corner[k] = std::uint32_t(lamps.vertices.size());
      lamps.vertices.push_back(scene.vertices[t.corner[k]]);
    }
    lamps.triangles.push_back(own);
  }
  for (const Sphere& s : scene.spheres) {
    if (shines(s)) lamps.spheres.push_back(s);
  }
  for (const Cylinder& c : scene.cylinders) {
    if (shines(c)) lamps.cylinders.push_back(c);
  }
  for (const Flat& r : scene.rectangles) {
    if (shines(r)) lamps.rectangles.push_back(r);
  }
  for (const Flat& d : scene.disks) {
    if (shines(d)) lamps.disks.push_back(d);
  }
  return lamps;
}

}  // namespace

ResampledDirect::ResampledDirect(const Scene& scene, int candidates)
    : world_(scene), lamps_(lamps_of(scene)), candidates_(std::size_t(candidates)) {
  if (candidates < 1 || candidates_ > max_split)
    throw Error("cannot take " + std::to_string(candidates) + " candidates", "--split", "choose 1 to 64");
  lamps_embree_.emplace(lamps_);
}

ResampledDirect::Arriving ResampledDirect::unshadowed(Point at, Direction direction) const {
  if (const auto hit = lamps_embree_->intersect({at, direction, world_.near(at)}))
    return {PathVertex(lamps_, *hit, at, direction).emitted(), hit->distance};
  const auto& sky = world_.scene.environment;
  return {sky ? sky->radiance(direction) : Rgb{}, std::numeric_limits<float>::infinity()};
}

Rgb ResampledDirect::radiance(Point origin, Direction direction, PathBits& u) const {
  if (world_.scene.max_depth == 0) return {};
  const auto hit = world_.seen(world_.camera_ray(origin, direction));
  if (!hit) return world_.backdrop(direction);
  const PathVertex at(world_.scene, *hit, origin, direction);
  return at.emitted() + (world_.scene.max_depth == 1 ? Rgb{} : reflected(at, u));
}

Rgb ResampledDirect::reflected(const PathVertex& at, PathBits& u) const {
  Rgb result;
  u.begin(1, Decision::light);
  if (const auto light = world_.lights.sample(at.on.at, u); light && light->delta) {
    const Direction wi = to_local(at.frame, light->direction);
    const Rgb arriving = at.f_cos(wi) * light->radiance;
    if (arriving != Rgb{} && world_.sees(at.on.at, light->direction, light->distance))
      result = (1 / light->pdf) * arriving;
  }
  std::array<Scattered, max_split> drawn;
  std::array<PathBits, max_split> branches;
  for (std::uint32_t k = 0; k < candidates_; ++k) {
    branches[k] = u.branch(k, std::uint32_t(candidates_));
    branches[k].begin(1, Decision::surface);
  }
  const std::size_t filled =
      at.sample_n(std::span(branches).first(candidates_), std::span(drawn).first(candidates_));
  float sum = 0, kept_q = 0;
  Rgb kept;
  Direction kept_direction{};
  float kept_distance = 0;
  u.begin(1, Decision::survival);
  double pick = to_unit_double(u());  // renewed from what is left of it: one word keeps one of M
  for (std::size_t i = 0; i < filled; ++i) {
    const Direction direction = normalize(to_world(at.frame, drawn[i].wi));
    const Arriving light = unshadowed(at.on.at, direction);
    const Rgb product = drawn[i].weight * light.radiance;
    const float q = Target::norm(product);
    if (!(q > 0)) continue;
    sum += q;
    const double chance = double(q) / double(sum);
    if (pick < chance) {
      kept = product, kept_q = q, kept_direction = direction, kept_distance = light.distance;
      pick /= chance;
    } else {
      pick = (pick - chance) / (1 - chance);
    }
  }
  if (!(kept_q > 0) || !world_.sees(at.on.at, kept_direction, kept_distance)) return result;
  return result + (sum / (kept_q * float(candidates_))) * kept;
}

}  // namespace reflectree::render
