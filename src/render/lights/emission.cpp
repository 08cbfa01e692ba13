// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/lights/emission.hpp"

#include <algorithm>
#include <cmath>

#include "materials/cosine_lobe.hpp"
#include "reflectree/render/integrators/profile.hpp"
#include "shapes/flat.hpp"

namespace reflectree::render {

namespace {

using reflectree::pi;

double sum(Rgb c) { return double(c.r) + double(c.g) + double(c.b); }

float area_of(const Scene& scene, const Triangle& t) {
  const Point a = scene.vertices[t.corner[0]].at;
  return length(cross(scene.vertices[t.corner[1]].at - a, scene.vertices[t.corner[2]].at - a)) / 2;
}
float area_of(const Sphere& s) { return float(4 * M_PI * s.radius * s.radius); }

// Of directions in which it sends light.
float cone(const SpotLight& p) { return 2 * pi * (1 - std::cos(p.cutoff)); }

Direction uniform_direction(PathBits& u) {
  const float z = 1 - 2 * to_unit_float(u()), phi = 2 * pi * to_unit_float(u());
  const float r = std::sqrt(std::max(0.f, 1 - z * z));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// The sky's radiance over all directions, roughly: its share of the photons follows from it, not their power.
Rgb whole(const Environment& sky) {
  constexpr int n = 1024;
  Rgb total;
  PathBits u(Pcg32(1));
  for (int i = 0; i < n; ++i) {
    const auto light = sky.sample(u).light;
    if (light.pdf > 0) total = total + (1 / (light.pdf * n)) * light.radiance;
  }
  return total;
}

}  // namespace

void Emission::enclose() {
  Point low{1e30f, 1e30f, 1e30f}, high = -low;
  const auto hold = [&](Point p, float r) {
    low = {std::min(low.x, p.x - r), std::min(low.y, p.y - r), std::min(low.z, p.z - r)};
    high = {std::max(high.x, p.x + r), std::max(high.y, p.y + r), std::max(high.z, p.z + r)};
  };
  for (const Triangle& t : scene_.triangles) {
    for (const std::uint32_t c : t.corner) hold(scene_.vertices[c].at, 0);
  }
  for (const Sphere& s : scene_.spheres)
    hold({float(s.centre.x), float(s.centre.y), float(s.centre.z)}, float(s.radius));
  for (const Flat& r : scene_.rectangles) {
    for (const double x : {-1., 1.}) hold(point_on(r, x, -1), 0), hold(point_on(r, x, 1), 0);
  }
  for (const Flat& d : scene_.disks) hold(point_on(d, 0, 0), float(std::hypot(length(d.s), length(d.t))));
  for (const Cylinder& c : scene_.cylinders) {
    for (const double z : {0., 1.}) {
      const Vec3<double> end = c.base + z * c.axis;
      hold({float(end.x), float(end.y), float(end.z)}, float(length(c.s)));
    }
  }
  if (low.x > high.x) return;
  centre_ = .5f * (low + high);
  reach_ = 1.0001f * length(high - low) / 2;
}

void Emission::add(Source::Kind kind, std::size_t index, Rgb power) {
  if (!(sum(power) > 0)) return;
  sources_.push_back({kind, std::uint32_t(index)});
  cdf_.push_back((cdf_.empty() ? 0 : cdf_.back()) + sum(power));
}

Emission::Emission(const Scene& scene) : scene_(scene) {
  using Kind = Source::Kind;
  enclose();
  const auto area = [&](Kind kind, std::size_t i, std::uint32_t surface, float size) {
    add(kind, i, (pi * size) * scene.surfaces[surface].radiance);
  };
  for (std::size_t i = 0; i < scene.triangles.size(); ++i)
    area(Kind::triangle, i, scene.triangles[i].surface, area_of(scene, scene.triangles[i]));
  for (std::size_t i = 0; i < scene.spheres.size(); ++i)
    area(Kind::sphere, i, scene.spheres[i].surface, area_of(scene.spheres[i]));
  for (std::size_t i = 0; i < scene.rectangles.size(); ++i)
    area(Kind::rectangle, i, scene.rectangles[i].surface, float(rectangle_area(scene.rectangles[i])));
  for (std::size_t i = 0; i < scene.disks.size(); ++i)
    area(Kind::disk, i, scene.disks[i].surface, float(disk_area(scene.disks[i])));
  for (std::size_t i = 0; i < scene.cylinders.size(); ++i)
    area(Kind::cylinder, i, scene.cylinders[i].surface, float(cylinder_area(scene.cylinders[i])));
  for (std::size_t i = 0; i < scene.spot_lights.size(); ++i)
    add(Kind::spot, i, cone(scene.spot_lights[i]) * scene.spot_lights[i].intensity);
  for (std::size_t i = 0; i < scene.point_lights.size(); ++i)
    add(Kind::point, i, (4 * pi) * scene.point_lights[i].intensity);
  const float shade = pi * reach_ * reach_;
  for (std::size_t i = 0; i < scene.directional_lights.size(); ++i)
    add(Kind::directional, i, shade * scene.directional_lights[i].irradiance);
  if (scene.environment) add(Kind::environment, 0, shade * whole(*scene.environment));
}

// `irradiance`, of a surface that faces the light, on the disk.
Emitted Emission::from_far(Direction direction, Rgb irradiance, PathBits& u) const {
  const auto frame = frame_from_normal(direction);
  const float r = reach_ * std::sqrt(to_unit_float(u())), phi = 2 * pi * to_unit_float(u());
  const Point at =
      centre_ - reach_ * direction + (r * std::cos(phi)) * frame.s + (r * std::sin(phi)) * frame.t;
  return {at, direction, (pi * reach_ * reach_) * irradiance, false};
}

std::optional<Emitted> Emission::sample(PathBits& u) const {
  if (sources_.empty()) return std::nullopt;
  const InPhase sampling(Phase::sample);
  const double pick = to_unit_double(u()) * cdf_.back();
  const auto i = std::size_t(std::upper_bound(cdf_.begin(), cdf_.end() - 1, pick) - cdf_.begin());
  const double chance = (cdf_[i] - (i > 0 ? cdf_[i - 1] : 0)) / cdf_.back();
  const std::uint32_t index = sources_[i].index;
  const auto leaving = [&](Hit::Kind kind, float size, double a, double b, Point origin, Direction towards) {
    const Interaction on = interaction_at(scene_, {kind, index, 1, a, b}, origin, towards);
    u.begin(1, Decision::light);
    const Direction d = to_world(frame_from_normal(on.normal()), cosine_direction(u));
    const Rgb radiance = dot(on.shading, d) > 0 ? radiance_of(scene_.surfaces[on.surface], on.uv) : Rgb{};
    return Emitted{on.at, d, (pi * size) * radiance, true};
  };
  Emitted e{};
  switch (sources_[i].kind) {
    case Source::Kind::triangle: {
      const double root = std::sqrt(to_unit_double(u())), c = root * to_unit_double(u());
      e = leaving(Hit::Kind::triangle, area_of(scene_, scene_.triangles[index]), root - c, c, {}, {});
      break;
    }
    case Source::Kind::sphere: {
      const Sphere& s = scene_.spheres[index];
      const Point centre{float(s.centre.x), float(s.centre.y), float(s.centre.z)};
      e = leaving(Hit::Kind::sphere, area_of(s), 0, 0, centre, uniform_direction(u));
      break;
    }
    case Source::Kind::rectangle: {
      const auto [x, y] = in_rectangle(u);
      e = leaving(Hit::Kind::rectangle, float(rectangle_area(scene_.rectangles[index])), x, y, {}, {});
      break;
    }
    case Source::Kind::disk: {
      const auto [x, y] = in_disk(u);
      e = leaving(Hit::Kind::disk, float(disk_area(scene_.disks[index])), x, y, {}, {});
      break;
    }
    case Source::Kind::cylinder: {
      const Cylinder& c = scene_.cylinders[index];
      const auto [x, y, z] = in_cylinder(u);
      const Vec3<double> centre = c.base + z * c.axis, out = x * c.s + y * c.t;
      e = leaving(Hit::Kind::cylinder, float(cylinder_area(c)), 0, 0,
                  {float(centre.x), float(centre.y), float(centre.z)},
                  {float(out.x), float(out.y), float(out.z)});
      break;
    }
    case Source::Kind::spot: {
      const SpotLight& p = scene_.spot_lights[index];
      const float z = 1 - to_unit_float(u()) * (1 - std::cos(p.cutoff)),
                  r = std::sqrt(std::max(0.f, 1 - z * z)), phi = 2 * pi * to_unit_float(u());
      const Direction along = to_world(p.frame, {r * std::cos(phi), r * std::sin(phi), z});
      e = {p.at, along, cone(p) * p.towards(along), true};
      break;
    }
    case Source::Kind::point: {
      const PointLight& p = scene_.point_lights[index];
      e = {p.at, uniform_direction(u), (4 * pi) * p.intensity, true};
      break;
    }
    case Source::Kind::directional: {
      const DirectionalLight& d = scene_.directional_lights[index];
      e = from_far(d.direction, d.irradiance, u);
      break;
    }
    case Source::Kind::environment: {
      const auto [d, light] = scene_.environment->sample(u);
      u.begin(1, Decision::light);
      e = from_far(-d, (1 / light.pdf) * light.radiance, u);
      break;
    }
  }
  e.power = float(1 / chance) * e.power;
  if (!(sum(e.power) > 0)) return std::nullopt;
  return e;
}

}  // namespace reflectree::render
