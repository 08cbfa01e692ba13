// SPDX-License-Identifier: Apache-2.0
// The scene's shapes in Embree 3, robust; all but triangles are ours. Nothing else knows Embree.
#pragma once

#include <limits>
#include <memory>
#include <span>

#include "reflectree/render/scene.hpp"

namespace reflectree::render {

struct Hit {
  enum class Kind : std::uint8_t { triangle, sphere, rectangle, disk, cylinder } kind;
  std::uint32_t index;
  float distance;
  double u, v;  // a triangle's barycentric weights of its second and third corner; a flat shape's x and y
};

struct Ray {
  Point origin;
  Direction direction;
  float near = 0, far = std::numeric_limits<float>::infinity();
};

class EmbreeScene {
 public:
  // Holds a reference to `scene`. Throws Error where Embree fails.
  explicit EmbreeScene(const Scene& scene);
  std::optional<Hit> intersect(const Ray& ray) const;
  bool occluded(const Ray& ray) const;
  // Many at once, in packets. `coherent`: neighbours go much the same way.
  void intersect(std::span<const Ray> rays, bool coherent, std::span<std::optional<Hit>> out) const;
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> out) const;

 private:
  const Scene& shapes_;
  std::shared_ptr<void> device_, scene_;
};

// What lies at a hit.
struct Interaction {
  Point at;
  Direction face;     // along the normal of the surface itself, on the side of `shading`; of any length
  Direction shading;  // decides what is front and back, as in Mitsuba
  Uv uv;
  std::uint32_t surface;
  Direction normal() const { return normalize(face); }
};
inline std::uint32_t surface_of(const Scene& scene, const Hit& hit) {
  switch (hit.kind) {
    case Hit::Kind::triangle:
      return scene.triangles[hit.index].surface;
    case Hit::Kind::sphere:
      return scene.spheres[hit.index].surface;
    case Hit::Kind::rectangle:
      return scene.rectangles[hit.index].surface;
    case Hit::Kind::cylinder:
      return scene.cylinders[hit.index].surface;
    default:
      return scene.disks[hit.index].surface;
  }
}
Interaction interaction_at(const Scene& scene, const Hit& hit, Point origin, Direction direction);

// How the surface's points move as u and v grow, per unit of them. Without texture coordinates a triangle's
// u and v are the shares of its corners.
struct Tangents {
  Direction du, dv;
};
// What the mesh says there, by Texture::attribute.
std::array<Rgb, max_attributes> attributes_at(const Scene& scene, const Hit& hit);
Tangents tangents_at(const Scene& scene, const Hit& hit, const Interaction& on);
// x along `du`, made perpendicular to `normal`; any frame where du has no such part. As in Mitsuba, y does
// not turn with v: the frame is right-handed.
LocalFrame<float> frame_along(Direction normal, Direction du);

}  // namespace reflectree::render
