// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "reflectree/render/embree_scene.hpp"

namespace reflectree::render {

namespace {

Interaction on_triangle(const Scene& scene, const Hit& hit) {
  const Triangle& t = scene.triangles[hit.index];
  const Vertex &a = scene.vertices[t.corner[0]], &b = scene.vertices[t.corner[1]],
               &c = scene.vertices[t.corner[2]];
  const float w = 1 - hit.u - hit.v;
  const Direction own = cross(b.at - a.at, c.at - a.at);
  const Direction smooth = w * a.normal + hit.u * b.normal + hit.v * c.normal;
  const float size2 = dot(smooth, smooth);
  const Direction shading = size2 > 1e-12f ? (1 / std::sqrt(size2)) * smooth : normalize(own);
  return {w * a.at + hit.u * b.at + hit.v * c.at,
          dot(own, shading) < 0 ? -own : own,
          shading,
          {w * a.uv.x + hit.u * b.uv.x + hit.v * c.uv.x, w * a.uv.y + hit.u * b.uv.y + hit.v * c.uv.y},
          t.surface};
}

Interaction on_sphere(const Sphere& s, Point about) {
  const Vec3<double> from = Vec3<double>{about.x, about.y, about.z} - s.centre, out = normalize(from);
  const Vec3<double> at = s.centre + s.radius * out;
  const Direction n{float(out.x), float(out.y), float(out.z)}, local = to_local(s.axes, n);
  const float turn = std::atan2(local.y, local.x) / (2 * pi);
  const Direction facing = s.inwards ? -n : n;
  return {{float(at.x), float(at.y), float(at.z)},
          facing,
          facing,
          {turn < 0 ? turn + 1 : turn, std::acos(clamp(local.z, -1.f, 1.f)) / pi},
          s.surface};
}

Interaction on_disk(const Disk& d, Point at) {
  const Direction n = normalize(cross(d.s, d.t));
  const Point from = at - d.centre;
  const float x = dot(from, d.s) / dot(d.s, d.s), y = dot(from, d.t) / dot(d.t, d.t);
  const float turn = std::atan2(y, x) / (2 * pi);
  return {at, n, n, {std::sqrt(x * x + y * y), turn < 0 ? turn + 1 : turn}, d.surface};
}

}  // namespace

Interaction interaction_at(const Scene& scene, const Hit& hit, Point origin, Direction direction) {
  if (hit.kind == Hit::Kind::triangle) return on_triangle(scene, hit);
  const Point at = origin + hit.distance * direction;
  return hit.kind == Hit::Kind::sphere ? on_sphere(scene.spheres[hit.index], at)
                                       : on_disk(scene.disks[hit.index], at);
}

}  // namespace reflectree::render
