// SPDX-License-Identifier: Apache-2.0
// The scene's triangles in Embree 3, robust. Nothing else knows Embree.
#pragma once

#include <memory>

#include "reflectree/render/scene.hpp"

namespace reflectree::render {

struct Hit {
  std::uint32_t triangle;
  float distance;
};

class EmbreeScene {
 public:
  // Holds a reference to the points of `scene`. Throws Error where Embree fails.
  explicit EmbreeScene(const Scene& scene);
  std::optional<Hit> intersect(Point origin, Direction direction, float near) const;
  bool occluded(Point origin, Direction direction, float near, float far) const;

 private:
  std::shared_ptr<void> device_, scene_;
};

}  // namespace reflectree::render
