// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/lights/lights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reflectree/math/fast_functions.hpp"
#include "reflectree/render/integrators/profile.hpp"
#include "shapes/flat.hpp"

namespace reflectree::render {

namespace {

constexpr float far_away = std::numeric_limits<float>::infinity();

bool shines(Rgb c) { return c.r + c.g + c.b > 0; }

// 1 - cos of the cone that a sphere fills, seen from outside; sin^2 / (1 + cos) does not cancel. 0 inside.
double cone_of(const Sphere& s, double distance2) {
  const double sin2 = s.radius * s.radius / distance2;
  return sin2 < 1 ? sin2 / (1 + std::sqrt(1 - sin2)) : 0;
}
float cone_density(double cone) { return float(1 / (2 * M_PI * cone)); }

// Distances are in double precision: they cancel at the rim.
REFLECTREE_INLINE std::optional<LightSample> sample_sphere(const Sphere& s, Point at, float share,
                                                           Rgb radiance, PathBits& u) {
  const Vec3<double> to = s.centre - to_double(at);
  const double d2 = dot(to, to), d = std::sqrt(d2), cone = cone_of(s, d2);
  if (!(cone > 0) || s.inwards) return std::nullopt;
  const double drop = to_unit_double(u()) * cone, sin2 = drop * (2 - drop), cosine = 1 - drop;
  const auto [x, y] = on_circle(to_unit_float(u()));
  const float sine = std::sqrt(float(sin2)), over = 1 / float(d);
  const auto frame = frame_from_normal(over * Direction{float(to.x), float(to.y), float(to.z)});
  const double chord = std::sqrt(std::max(0., s.radius * s.radius - d2 * sin2));
  return LightSample{to_world(frame, {sine * x, sine * y, float(cosine)}), float(d * cosine - chord),
                     share * cone_density(cone), false, radiance};
}

REFLECTREE_INLINE std::optional<LightSample> sample_area(Point at, Point on, Direction normal, float density,
                                                         Rgb radiance) {
  const Direction to = on - at;
  const float facing = -dot(normal, to);  // the cosine times the distance
  if (!(facing > 0)) return std::nullopt;
  const float distance2 = dot(to, to), distance = std::sqrt(distance2);
  return LightSample{(1 / distance) * to, distance, distance2 * density * (distance / facing), false,
                     radiance};
}

// The part whose share of the areas' sums, all but the last, `pick` falls into; without branches, which would
// be a toss-up.
std::size_t part_at(const std::vector<double>& cdf, double pick) {
  const double* first = cdf.data();
  for (std::size_t n = cdf.size(); n > 1;) {
    const std::size_t half = n / 2;
    first += first[half - 1] <= pick ? half : 0;
    n -= half;
  }
  return std::size_t(first - cdf.data());
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

Rgb SpotLight::towards(Direction direction) const {
  const Direction w = to_local(frame, direction);
  if (tan_x > 0) {
    const float u = .5f - .5f * w.x / (w.z * tan_x), v = .5f - .5f * w.y / (w.z * tan_y);
    if (!(w.z > 0 && u >= 0 && u <= 1 && v >= 0 && v <= 1)) return {};
    const Rgb shown = picture ? intensity * eval(*picture, {{u, v}}) : intensity;
    return (1 / (w.z * w.z * w.z)) * shown;
  }
  const float angle = angle_of(std::sqrt(sin2_theta(w)), w.z);
  if (!(angle < cutoff)) return {};
  const float fall = angle <= beam ? 1 : (cutoff - angle) / (cutoff - beam);
  if (!picture) return fall * intensity;
  const float over = .5f / (w.z * std::tan(cutoff));
  return fall * (intensity * eval(*picture, {{.5f + over * w.x, .5f + over * w.y}}));
}

Lights::Lights(const Scene& scene) : scene_(scene), area_(scene.surfaces.size()) {
  using Kind = Light::Kind;
  std::vector<std::size_t> light_of(scene.surfaces.size(), std::size_t(-1));
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle& t = scene.triangles[i];
    if (!shines(scene.surfaces[t.surface].radiance)) continue;
    if (light_of[t.surface] == std::size_t(-1)) {
      light_of[t.surface] = lights_.size();
      lights_.push_back({Kind::mesh, t.surface, scene.surfaces[t.surface].radiance, 0, {}, {}});
    }
    const Point a = scene.vertices[t.corner[0]].at;
    const Direction ab = scene.vertices[t.corner[1]].at - a, ac = scene.vertices[t.corner[2]].at - a;
    area_[t.surface] += double(length(cross(ab, ac))) / 2;
    Light& light = lights_[light_of[t.surface]];
    light.parts.push_back({i, a, ab, ac, facing(scene, t)}), light.cdf.push_back(area_[t.surface]);
  }
  const auto add = [&](Kind kind, std::size_t i, Rgb radiance, double area) {
    lights_.push_back({kind, std::uint32_t(i), radiance, float(1 / area), {}, {}});
  };
  const auto add_shining = [&](Kind kind, const auto& shapes, const auto& area) {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const Rgb radiance = scene.surfaces[shapes[i].surface].radiance;
      if (shines(radiance)) add(kind, i, radiance, area(shapes[i]));
    }
  };
  add_shining(Kind::sphere, scene.spheres, [](const Sphere&) { return 1; });
  add_shining(Kind::rectangle, scene.rectangles, rectangle_area);
  add_shining(Kind::disk, scene.disks, disk_area);
  add_shining(Kind::cylinder, scene.cylinders, cylinder_area);
  for (std::size_t i = 0; i < scene.point_lights.size(); ++i) add(Kind::point, i, {}, 1);
  for (std::size_t i = 0; i < scene.spot_lights.size(); ++i) add(Kind::spot, i, {}, 1);
  for (std::size_t i = 0; i < scene.directional_lights.size(); ++i) add(Kind::directional, i, {}, 1);
  if (scene.environment) add(Kind::environment, 0, {}, 1);
  share_ = 1 / float(lights_.size());
  for (Light& light : lights_) {
    if (light.kind == Kind::mesh) light.density = float(1 / light.cdf.back());
    light.density *= share_;
  }
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
      out[places[k]] = LightSample{drawn[k].direction, far_away, share_ * drawn[k].light.pdf, false,
                                   drawn[k].light.radiance};
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

void Lights::look_up(const Hit& hit, Point at, std::optional<LightSample>& s) const {
  if (!s) return;
  const Surface& surface = scene_.surfaces[surface_of(scene_, hit)];
  if (surface.shine) s->radiance = radiance_of(surface, interaction_at(scene_, hit, at, s->direction).uv);
}

// In place: `s` is empty before.
void Lights::sample_light(const Light& light, Point at, PathBits& u, std::optional<LightSample>& s) const {
  switch (light.kind) {
    case Light::Kind::mesh: {
      const Part& part = light.parts[part_at(light.cdf, to_unit_double(u()) * light.cdf.back())];
      const float root = std::sqrt(to_unit_float(u())), c = root * to_unit_float(u()), b = root - c;
      Direction normal = part.normal;
      if (normal == Direction{}) {
        const Hit hit{Hit::Kind::triangle, part.triangle, 0, double(b), double(c)};
        normal = interaction_at(scene_, hit, {}, {}).normal();
      }
      s = sample_area(at, part.at + b * part.ab + c * part.ac, normal, light.density, light.radiance);
      look_up({Hit::Kind::triangle, part.triangle, 0, double(b), double(c)}, at, s);
      break;
    }
    case Light::Kind::sphere:
      s = sample_sphere(scene_.spheres[light.index], at, share_, light.radiance, u);
      look_up({Hit::Kind::sphere, light.index, s ? s->distance : 0, 0, 0}, at, s);
      break;
    case Light::Kind::rectangle: {
      const Flat& r = scene_.rectangles[light.index];
      const auto [x, y] = in_rectangle(u);
      s = sample_area(at, point_on(r, x, y), r.normal, light.density, light.radiance);
      look_up({Hit::Kind::rectangle, light.index, 0, x, y}, at, s);
      break;
    }
    case Light::Kind::disk: {
      const Flat& d = scene_.disks[light.index];
      const auto [x, y] = in_disk(u);
      s = sample_area(at, point_on(d, x, y), d.normal, light.density, light.radiance);
      look_up({Hit::Kind::disk, light.index, 0, x, y}, at, s);
      break;
    }
    case Light::Kind::cylinder: {
      const Cylinder& c = scene_.cylinders[light.index];
      const auto [x, y, z] = in_cylinder(u);
      const Vec3<double> out = x * c.s + y * c.t, p = c.base + out + z * c.axis,
                         n = (c.inwards ? -1 : 1) * normalize(out);
      s = sample_area(at, {float(p.x), float(p.y), float(p.z)}, {float(n.x), float(n.y), float(n.z)},
                      light.density, light.radiance);
      look_up({Hit::Kind::cylinder, light.index, s ? s->distance : 0, 0, 0}, at, s);
      break;
    }
    case Light::Kind::point: {
      const PointLight& p = scene_.point_lights[light.index];
      const float distance = length(p.at - at);
      if (!(distance > 0)) return;
      s = LightSample{(1 / distance) * (p.at - at), distance, share_, true,
                      (1 / (distance * distance)) * p.intensity};
      break;
    }
    case Light::Kind::spot: {
      const SpotLight& p = scene_.spot_lights[light.index];
      const float distance = length(p.at - at);
      if (!(distance > 0)) return;
      const Direction to = (1 / distance) * (p.at - at);
      const Rgb intensity = p.towards(-to);
      if (intensity != Rgb{})
        s = LightSample{to, distance, share_, true, (1 / (distance * distance)) * intensity};
      break;
    }
    case Light::Kind::directional: {
      const DirectionalLight& d = scene_.directional_lights[light.index];
      s = LightSample{-d.direction, far_away, share_, true, d.irradiance};
      break;
    }
    case Light::Kind::environment: {
      const auto drawn = scene_.environment->sample(u);
      s = LightSample{drawn.direction, far_away, share_ * drawn.light.pdf, false, drawn.light.radiance};
      break;
    }
  }
}

float Lights::pdf(Point at, Direction direction, const Hit& hit, const Interaction& on) const {
  if (!shines(scene_.surfaces[on.surface].radiance)) return 0;
  const float cosine = -dot(on.normal(), direction);
  if (!(cosine > 0)) return 0;
  if (hit.kind == Hit::Kind::sphere) {
    const Sphere& s = scene_.spheres[hit.index];
    const Vec3<double> to = s.centre - to_double(at);
    const double cone = cone_of(s, dot(to, to));
    return cone > 0 && !s.inwards ? share_ * cone_density(cone) : 0;
  }
  const double area = hit.kind == Hit::Kind::rectangle  ? rectangle_area(scene_.rectangles[hit.index])
                      : hit.kind == Hit::Kind::disk     ? disk_area(scene_.disks[hit.index])
                      : hit.kind == Hit::Kind::cylinder ? cylinder_area(scene_.cylinders[hit.index])
                                                        : area_[on.surface];
  return share_ * hit.distance * hit.distance / (cosine * float(area));
}

Environment::Light Lights::environment(Direction direction) const {
  const auto light = scene_.environment->at(direction);
  return {light.radiance, share_ * light.pdf};
}

void Lights::environment(std::span<const Direction> directions, std::span<Environment::Light> out) const {
  scene_.environment->at(directions, out);
  for (Environment::Light& light : out.first(directions.size())) light.pdf *= share_;
}

}  // namespace reflectree::render
