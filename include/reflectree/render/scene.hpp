// SPDX-License-Identifier: Apache-2.0
// A scene as plain data: triangles in world space, what covers them, one camera. Read from the part of
// Mitsuba 3's XML that docs/architecture.md names; whatever else a file asks for is an Error with its line.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/sampler/any_sampler.hpp"
#include "reflectree/sampler/host.hpp"

namespace reflectree::render {

using Point = Vec3<float>;

// A Lambertian surface where there is no sampler.
struct Surface {
  Rgb albedo{.5f, .5f, .5f};
  bool two_sided = false;
  std::optional<AnyBrdf> f;
  std::optional<AnySampler<Spectrum>> sampler;
};

struct Triangle {
  std::array<std::uint32_t, 3> corner{};
  std::uint32_t surface = 0;
  Rgb radiance;  // emitted to the side of the normal, (p1 - p0) x (p2 - p0)
};

struct Camera {
  Point origin, left, up, forward;  // an orthonormal basis
  float tan_x = 1, tan_y = 1;       // half the picture's width and height at distance 1
};

struct Scene {
  std::vector<Point> points;
  std::vector<Triangle> triangles;
  std::vector<Surface> surfaces;
  Rgb sky;  // constant radiance from everywhere
  Camera camera;
  int width = 0, height = 0, samples = 16;
  int max_depth = 8;  // path edges, as in Mitsuba; -1: no limit
  int rr_depth = 5;
};

struct SceneOptions {
  std::map<std::string, std::string> defines;  // $name
  std::string sampler = "one-shot";            // of reflectree::samplers(), for type="reflectree"
};

// Throws Error, naming line and column.
Scene load_scene(const std::string& path, const SceneOptions& options = {}, const Host& host = {});
Scene parse_scene(std::string_view xml, const std::string& path, const SceneOptions& options = {},
                  const Host& host = {});

}  // namespace reflectree::render
