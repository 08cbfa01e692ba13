// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "flat.hpp"
#include "reflectree/brdf/shading_geometry.hpp"
#include "reflectree/math/fast_functions.hpp"
#include "reflectree/render/shapes/embree_scene.hpp"

namespace reflectree::render {

namespace {

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

}  // namespace

Interaction interaction_at(const Scene& scene, const Hit& hit, Point origin, Direction direction) {
  switch (hit.kind) {
    case Hit::Kind::triangle:
      return on_triangle(scene, hit);
    case Hit::Kind::rectangle:
      return on_rectangle(scene.rectangles[hit.index], hit);
    case Hit::Kind::disk:
      return on_disk(scene.disks[hit.index], hit);
    default:
      return on_sphere(scene.spheres[hit.index], origin + hit.distance * direction);
  }
}

}  // namespace reflectree::render
