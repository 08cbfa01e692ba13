// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/lights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "flat.hpp"
#include "reflectree/render/profile.hpp"

namespace reflectree::render {

namespace {

constexpr float far_away = std::numeric_limits<float>::infinity();

bool shines(Rgb c) { return c.r + c.g + c.b > 0; }

// 1 - cos of the cone that a sphere fills, seen from outside; sin^2 / (1 + cos) does not cancel. 0 inside.
double cone_of(const Sphere& s, Point at) {
  const Vec3<double> to = s.centre - Vec3<double>{at.x, at.y, at.z};
  const double sin2 = s.radius * s.radius / dot(to, to);
  return sin2 < 1 ? sin2 / (1 + std::sqrt(1 - sin2)) : 0;
}

REFLECTREE_INLINE std::optional<LightSample> sample_sphere(const Sphere& s, Point at, Rgb radiance,
                                                           PathBits& u) {
  const double cone = cone_of(s, at);
  if (!(cone > 0) || s.inwards) return std::nullopt;
  const Vec3<double> to = s.centre - Vec3<double>{at.x, at.y, at.z};
  const double d = length(to), drop = to_unit_double(u()) * cone;
  const float phi = 2 * pi * to_unit_float(u());
  const double sin2 = drop * (2 - drop), sine = std::sqrt(sin2), cosine = 1 - drop;
  const auto frame = frame_from_normal((1 / d) * to);
  const auto w =
      to_world(frame, Vec3<double>{sine * double(std::cos(phi)), sine * double(std::sin(phi)), cosine});
  const double chord = std::sqrt(std::max(0., s.radius * s.radius - d * d * sin2));
  return LightSample{{float(w.x), float(w.y), float(w.z)},
                     float(d * cosine - chord),
                     float(1 / (2 * M_PI * cone)),
                     false,
                     radiance};
}

REFLECTREE_INLINE std::optional<LightSample> sample_area(Point at, Point on, Direction normal, double area,
                                                         Rgb radiance) {
  const float distance = length(on - at);
  if (!(distance > 0)) return std::nullopt;
  const Direction direction = (1 / distance) * (on - at);
  const float cosine = -dot(normal, direction);
  if (!(cosine > 0)) return std::nullopt;
  return LightSample{direction, distance, distance * distance / (cosine * float(area)), false, radiance};
}

// A triangle's normal on the side of its corners' shading normals; zero where they do not agree on one.
Direction facing(const Scene& scene, const Triangle& t) {
  const Vertex &a = scene.vertices[t.corner[0]], &b = scene.vertices[t.corner[1]],
               &c = scene.vertices[t.corner[2]];
  const Direction own = cross(b.at - a.at, c.at - a.at);
  const float sides[] = {dot(own, a.normal), dot(own, b.normal), dot(own, c.normal)};
  const auto [low, high] = std::minmax_element(std::begin(sides), std::end(sides));
  return *low >= 0 ? normalize(own) : *high < 0 ? -normalize(own) : Direction{};
}

}  // namespace

Lights::Lights(const Scene& scene) : scene_(scene), area_(scene.surfaces.size()) {
  using Kind = Light::Kind;
  std::vector<std::size_t> light_of(scene.surfaces.size(), std::size_t(-1));
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle& t = scene.triangles[i];
    if (!shines(scene.surfaces[t.surface].radiance)) continue;
    if (light_of[t.surface] == std::size_t(-1)) {
      light_of[t.surface] = lights_.size();
      lights_.push_back({Kind::mesh, t.surface, {}, {}, {}});
    }
    const Point a = scene.vertices[t.corner[0]].at;
    area_[t.surface] +=
        double(length(cross(scene.vertices[t.corner[1]].at - a, scene.vertices[t.corner[2]].at - a))) / 2;
    Light& light = lights_[light_of[t.surface]];
    light.parts.push_back(i), light.cdf.push_back(area_[t.surface]);
    light.normals.push_back(facing(scene, t));
  }
  const auto add = [&](Kind kind, std::size_t i) { lights_.push_back({kind, std::uint32_t(i), {}, {}, {}}); };
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    if (shines(scene.surfaces[scene.spheres[i].surface].radiance)) add(Kind::sphere, i);
  }
  for (std::size_t i = 0; i < scene.rectangles.size(); ++i) {
    if (shines(scene.surfaces[scene.rectangles[i].surface].radiance)) add(Kind::rectangle, i);
  }
  for (std::size_t i = 0; i < scene.disks.size(); ++i) {
    if (shines(scene.surfaces[scene.disks[i].surface].radiance)) add(Kind::disk, i);
  }
  for (std::size_t i = 0; i < scene.point_lights.size(); ++i) add(Kind::point, i);
  for (std::size_t i = 0; i < scene.directional_lights.size(); ++i) add(Kind::directional, i);
  if (scene.environment) add(Kind::environment, 0);
}

const Lights::Light& Lights::chosen(PathBits& u) const {
  return lights_[std::size_t((std::uint64_t(u()) * lights_.size()) >> 32U)];
}

std::optional<LightSample> Lights::sample(Point at, PathBits& u) const {
  if (lights_.empty()) return std::nullopt;
  const InPhase sampling(Phase::sample);
  std::optional<LightSample> s;
  sample_light(chosen(u), at, u, s);
  return s;
}

void Lights::sample(std::span<const Point> at, std::span<PathBits* const> u,
                    std::span<std::optional<LightSample>> out) const {
  const InPhase sampling(Phase::sample);
  std::fill_n(out.begin(), at.size(), std::nullopt);
  std::array<PathBits*, 64> bits;
  std::array<std::uint32_t, bits.size()> places;
  std::array<Environment::Drawn, bits.size()> drawn;
  std::size_t waiting = 0;  // for the environment
  const auto from_environment = [&] {
    if (waiting == 0) return;
    scene_.environment->sample(std::span(bits).first(waiting), drawn);
    for (std::size_t k = 0; k < waiting; ++k)
      out[places[k]] = LightSample{drawn[k].direction, far_away, drawn[k].light.pdf / float(lights_.size()),
                                   false, drawn[k].light.radiance};
    waiting = 0;
  };
  for (std::size_t i = 0; i < at.size() && !lights_.empty(); ++i) {
    const Light& light = chosen(*u[i]);
    if (light.kind == Light::Kind::environment) {
      bits[waiting] = u[i], places[waiting] = std::uint32_t(i);
      if (++waiting == bits.size()) from_environment();
    } else {
      sample_light(light, at[i], *u[i], out[i]);
    }
  }
  from_environment();
}

// In place: `s` is empty before.
void Lights::sample_light(const Light& light, Point at, PathBits& u, std::optional<LightSample>& s) const {
  switch (light.kind) {
    case Light::Kind::mesh: {
      const double pick = to_unit_double(u()) * light.cdf.back();
      const auto i =
          std::size_t(std::upper_bound(light.cdf.begin(), light.cdf.end() - 1, pick) - light.cdf.begin());
      const double root = std::sqrt(to_unit_double(u())), c = root * to_unit_double(u()), b = root - c;
      const Rgb radiance = scene_.surfaces[light.index].radiance;
      if (light.normals[i] == Direction{}) {
        const Interaction on = interaction_at(scene_, {Hit::Kind::triangle, light.parts[i], 0, b, c}, {}, {});
        s = sample_area(at, on.at, on.normal(), light.cdf.back(), radiance);
      } else {
        const auto& corner = scene_.triangles[light.parts[i]].corner;
        const auto v = float(b), w = float(c);
        const Point on = (1 - v - w) * scene_.vertices[corner[0]].at + v * scene_.vertices[corner[1]].at +
                         w * scene_.vertices[corner[2]].at;
        s = sample_area(at, on, light.normals[i], light.cdf.back(), radiance);
      }
      break;
    }
    case Light::Kind::sphere: {
      const Sphere& sphere = scene_.spheres[light.index];
      s = sample_sphere(sphere, at, scene_.surfaces[sphere.surface].radiance, u);
      break;
    }
    case Light::Kind::rectangle: {
      const Flat& r = scene_.rectangles[light.index];
      const auto [x, y] = in_rectangle(u);
      s = sample_area(at, point_on(r, x, y), r.normal, rectangle_area(r),
                      scene_.surfaces[r.surface].radiance);
      break;
    }
    case Light::Kind::disk: {
      const Flat& d = scene_.disks[light.index];
      const auto [x, y] = in_disk(u);
      s = sample_area(at, point_on(d, x, y), d.normal, disk_area(d), scene_.surfaces[d.surface].radiance);
      break;
    }
    case Light::Kind::point: {
      const PointLight& p = scene_.point_lights[light.index];
      const float distance = length(p.at - at);
      if (!(distance > 0)) return;
      s = LightSample{(1 / distance) * (p.at - at), distance, 1, true,
                      (1 / (distance * distance)) * p.intensity};
      break;
    }
    case Light::Kind::directional: {
      const DirectionalLight& d = scene_.directional_lights[light.index];
      s = LightSample{-d.direction, far_away, 1, true, d.irradiance};
      break;
    }
    case Light::Kind::environment: {
      const auto drawn = scene_.environment->sample(u);
      s = LightSample{drawn.direction, far_away, drawn.light.pdf, false, drawn.light.radiance};
      break;
    }
  }
  if (s) s->pdf /= float(lights_.size());
}

float Lights::pdf(Point at, Direction direction, const Hit& hit, const Interaction& on) const {
  if (!shines(scene_.surfaces[on.surface].radiance)) return 0;
  const float cosine = -dot(on.normal(), direction), share = 1 / float(lights_.size());
  if (!(cosine > 0)) return 0;
  if (hit.kind == Hit::Kind::sphere) {
    const Sphere& s = scene_.spheres[hit.index];
    const double cone = cone_of(s, at);
    return cone > 0 && !s.inwards ? share * float(1 / (2 * M_PI * cone)) : 0;
  }
  const double area = hit.kind == Hit::Kind::rectangle ? rectangle_area(scene_.rectangles[hit.index])
                      : hit.kind == Hit::Kind::disk    ? disk_area(scene_.disks[hit.index])
                                                       : area_[on.surface];
  return share * hit.distance * hit.distance / (cosine * float(area));
}

Environment::Light Lights::environment(Direction direction) const {
  const auto light = scene_.environment->at(direction);
  return {light.radiance, light.pdf / float(lights_.size())};
}

void Lights::environment(std::span<const Direction> directions, std::span<Environment::Light> out) const {
  scene_.environment->at(directions, out);
  for (Environment::Light& light : out.first(directions.size())) light.pdf /= float(lights_.size());
}

}  // namespace reflectree::render
