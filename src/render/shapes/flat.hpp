// SPDX-License-Identifier: Apache-2.0
// Rectangles and disks: where rays cross their planes, how large they are, their points. And cylinders'.
#pragma once

#include "reflectree/math/fast_functions.hpp"
#include "reflectree/render/scene.hpp"

namespace reflectree::render {

inline Vec3<double> to_double(Point p) { return {p.x, p.y, p.z}; }

// o + distance d = centre + x s + y t, by Cramer's rule; not finite where the ray runs along the plane.
struct Crossing {
  double distance, x, y;
};
inline Crossing crossing(const Flat& flat, Point origin, Direction direction) {
  const Vec3<double> from = to_double(origin) - flat.centre, along = to_double(direction);
  const Vec3<double> n = cross(flat.s, flat.t), turned = cross(from, along);
  const double over = 1 / dot(along, n);
  return {-dot(from, n) * over, -dot(turned, flat.t) * over, dot(turned, flat.s) * over};
}

inline bool in_rectangle(double x, double y) { return std::abs(x) <= 1 && std::abs(y) <= 1; }
inline bool in_disk(double x, double y) { return x * x + y * y <= 1; }

inline Point point_on(const Flat& flat, double x, double y) {
  const Vec3<double> p = flat.centre + x * flat.s + y * flat.t;
  return {float(p.x), float(p.y), float(p.z)};
}

inline double rectangle_area(const Flat& flat) { return 4 * length(cross(flat.s, flat.t)); }
inline double disk_area(const Flat& flat) { return pi_v<double> * length(cross(flat.s, flat.t)); }

inline double cylinder_area(const Cylinder& c) { return 2 * pi_v<double> * length(c.s) * length(c.axis); }
// A uniform point's place: (x, y) on the unit circle, and z.
inline Vec3<double> in_cylinder(PathBits& u) {
  const double z = to_unit_double(u());
  const auto [x, y] = on_circle(to_unit_float(u()));
  return {double(x), double(y), z};
}

// Uniform coordinates of a rectangle's and of a disk's points.
inline Vec2<double> in_rectangle(PathBits& u) {
  const double x = 2 * to_unit_double(u()) - 1;
  return {x, 2 * to_unit_double(u()) - 1};
}
inline Vec2<double> in_disk(PathBits& u) {
  const double r = std::sqrt(to_unit_double(u()));
  const auto [x, y] = on_circle(to_unit_float(u()));
  return {r * double(x), r * double(y)};
}

}  // namespace reflectree::render
