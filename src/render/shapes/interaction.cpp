// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "flat.hpp"
#include "reflectree/brdf/shading_geometry.hpp"
#include "reflectree/math/fast_functions.hpp"
#include "reflectree/render/shapes/embree_scene.hpp"

namespace reflectree::render {

namespace {

Direction to_floats(Vec3<double> v) { return {float(v.x), float(v.y), float(v.z)}; }

Interaction on_triangle(const Scene& scene, const Hit& hit) {
  const Triangle& t = scene.triangles[hit.index];
  const Vertex &a = scene.vertices[t.corner[0]], &b = scene.vertices[t.corner[1]],
               &c = scene.vertices[t.corner[2]];
  const auto u = float(hit.u), v = float(hit.v), w = 1 - u - v;
  const Direction own = cross(b.at - a.at, c.at - a.at);
  const Direction smooth = w * a.normal + u * b.normal + v * c.normal;
  const float size2 = dot(smooth, smooth);
  const Direction shading = size2 > 1e-12f ? (1 / std::sqrt(size2)) * smooth : normalize(own);
  const auto mapping = scene.surfaces[t.surface].mapping;
  const Uv uv = mapping == Surface::Mapping::vertices
                    ? Uv{w * a.uv.x + u * b.uv.x + v * c.uv.x, w * a.uv.y + u * b.uv.y + v * c.uv.y}
                : mapping == Surface::Mapping::corners ? Uv{u, v}
                                                       : Uv{v, u};
  return {w * a.at + u * b.at + v * c.at, dot(own, shading) < 0 ? -own : own, shading, uv, t.surface};
}

Interaction on_sphere(const Sphere& s, Point about) {
  const Vec3<double> from = Vec3<double>{about.x, about.y, about.z} - s.centre, out = normalize(from);
  const Vec3<double> at = s.centre + s.radius * out;
  const Direction n{float(out.x), float(out.y), float(out.z)}, local = to_local(s.axes, n);
  const float turn = angle_of(local.y, local.x) / (2 * pi);
  const float polar = angle_of(std::sqrt(sin2_theta(local)), local.z) / pi;
  const Direction facing = s.inwards ? -n : n;
  return {{float(at.x), float(at.y), float(at.z)},
          facing,
          facing,
          {turn < 0 ? turn + 1 : turn, polar},
          s.surface};
}

Interaction on_rectangle(const Flat& r, const Hit& hit) {
  const auto half = [](double x) { return float((x + 1) / 2); };
  return {point_on(r, hit.u, hit.v), r.normal, r.normal, {half(hit.u), half(hit.v)}, r.surface};
}

Interaction on_disk(const Flat& d, const Hit& hit) {
  const auto x = float(hit.u), y = float(hit.v), turn = std::atan2(y, x) / (2 * pi);
  const Uv uv{std::sqrt(x * x + y * y), turn < 0 ? turn + 1 : turn};
  return {point_on(d, hit.u, hit.v), d.normal, d.normal, uv, d.surface};
}

// The sides of a triangle are (du, dv) times what u and v differ along them.
Tangents along_triangle(const Scene& scene, const Triangle& t) {
  const Vertex &a = scene.vertices[t.corner[0]], &b = scene.vertices[t.corner[1]],
               &c = scene.vertices[t.corner[2]];
  const Direction ab = b.at - a.at, ac = c.at - a.at;
  switch (scene.surfaces[t.surface].mapping) {
    case Surface::Mapping::corners:
      return {ab, ac};
    case Surface::Mapping::swapped_corners:
      return {ac, ab};
    case Surface::Mapping::vertices:
      break;
  }
  const float u1 = b.uv.x - a.uv.x, v1 = b.uv.y - a.uv.y, u2 = c.uv.x - a.uv.x, v2 = c.uv.y - a.uv.y;
  const float determinant = u1 * v2 - v1 * u2;
  if (determinant == 0) {
    const auto any = frame_from_normal(normalize(cross(ab, ac)));
    return {any.s, any.t};
  }
  const float over = 1 / determinant;
  return {over * (v2 * ab - v1 * ac), over * (u1 * ac - u2 * ab)};
}

Tangents along_sphere(const Sphere& s, const Interaction& on) {
  const Direction local = to_local(s.axes, s.inwards ? -on.shading : on.shading);
  const float r = float(s.radius), d = std::sqrt(sin2_theta(local)), over = d > 0 ? 1 / d : 0;
  const Direction down =
      d > 0 ? Direction{local.z * local.x * over, local.z * local.y * over, -d} : Direction{1, 0, 0};
  return {(2 * pi * r) * to_world(s.axes, {-local.y, local.x, 0}), (pi * r) * to_world(s.axes, down)};
}

// u grows outwards, v round.
Tangents along_disk(const Flat& d, const Hit& hit) {
  const double r = std::hypot(hit.u, hit.v), over = r > 0 ? 1 / r : 0;
  return {to_floats((hit.u * over) * d.s + (hit.v * over) * d.t),
          to_floats(2 * pi_v<double> * (hit.u * d.t - hit.v * d.s))};
}

// Where a point on or near the cylinder is, by s and t, on the unit circle, and z.
Vec3<double> on_unit(const Cylinder& c, Vec3<double> at) {
  const Vec3<double> from = at - c.base;
  const double r2 = dot(c.s, c.s), x = dot(from, c.s) / r2, y = dot(from, c.t) / r2,
               over = 1 / std::hypot(x, y);
  return {x * over, y * over, clamp(dot(from, c.axis) / dot(c.axis, c.axis), 0., 1.)};
}

[[gnu::noinline]] Interaction on_cylinder(const Cylinder& c, Point about) {
  const Vec3<double> local = on_unit(c, to_double(about)), out = local.x * c.s + local.y * c.t;
  const Direction n = to_floats((c.inwards ? -1 : 1) * normalize(out));
  const float turn = std::atan2(float(local.y), float(local.x)) / (2 * pi);
  return {to_floats(c.base + out + local.z * c.axis),
          n,
          n,
          {turn < 0 ? turn + 1 : turn, float(local.z)},
          c.surface};
}

Tangents along_cylinder(const Cylinder& c, const Interaction& on) {
  const Vec3<double> local = on_unit(c, to_double(on.at));
  return {to_floats(2 * pi_v<double> * (local.x * c.t - local.y * c.s)), to_floats(c.axis)};
}

}  // namespace

std::array<Rgb, max_attributes> attributes_at(const Scene& scene, const Hit& hit) {
  std::array<Rgb, max_attributes> found{};
  if (hit.kind != Hit::Kind::triangle) return found;
  const Triangle& t = scene.triangles[hit.index];
  const Surface& surface = scene.surfaces[t.surface];
  const auto u = float(hit.u), v = float(hit.v);
  for (std::size_t i = 0; i < std::min(found.size(), surface.attributes.size()); ++i) {
    const Surface::Attribute& a = surface.attributes[i];
    const auto at = [&](std::size_t k) { return k < a.values.size() ? a.values[k] : Rgb{}; };
    const auto corner = [&](std::size_t k) { return at(t.corner[k] - surface.first_vertex); };
    found[i] = a.of_triangles ? at(hit.index - surface.first_triangle)
                              : (1 - u - v) * corner(0) + u * corner(1) + v * corner(2);
  }
  return found;
}

Tangents tangents_at(const Scene& scene, const Hit& hit, const Interaction& on) {
  switch (hit.kind) {
    case Hit::Kind::triangle:
      return along_triangle(scene, scene.triangles[hit.index]);
    case Hit::Kind::rectangle: {
      const Flat& r = scene.rectangles[hit.index];
      return {to_floats(2. * r.s), to_floats(2. * r.t)};
    }
    case Hit::Kind::disk:
      return along_disk(scene.disks[hit.index], hit);
    case Hit::Kind::cylinder:
      return along_cylinder(scene.cylinders[hit.index], on);
    default:
      return along_sphere(scene.spheres[hit.index], on);
  }
}

LocalFrame<float> frame_along(Direction normal, Direction du) {
  const Direction across = du - dot(normal, du) * normal;
  const float size2 = dot(across, across);
  if (!(size2 > 1e-12f * dot(du, du))) return frame_from_normal(normal);
  const Direction s = (1 / std::sqrt(size2)) * across;
  return {s, cross(normal, s), normal};
}

Interaction interaction_at(const Scene& scene, const Hit& hit, Point origin, Direction direction) {
  switch (hit.kind) {
    case Hit::Kind::triangle:
      return on_triangle(scene, hit);
    case Hit::Kind::rectangle:
      return on_rectangle(scene.rectangles[hit.index], hit);
    case Hit::Kind::disk:
      return on_disk(scene.disks[hit.index], hit);
    case Hit::Kind::cylinder:
      return on_cylinder(scene.cylinders[hit.index], origin + hit.distance * direction);
    default:
      return on_sphere(scene.spheres[hit.index], origin + hit.distance * direction);
  }
}

}  // namespace reflectree::render
