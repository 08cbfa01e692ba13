// SPDX-License-Identifier: Apache-2.0
// A scene as plain data: shapes in world space, what covers them, lights, one camera. Read from the part of
// Mitsuba 3's XML that docs/render.md names; whatever else a file asks for is an Error with its line.
#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "reflectree/host.hpp"
#include "reflectree/render/lights/environment.hpp"
#include "reflectree/render/materials/scattering.hpp"

namespace reflectree::render {

using Point = Vec3<float>;

struct Surface {
  ScatteringPtr scattering;
  Rgb radiance;  // emitted to the side of the normal
  // How triangles get u and v: from their vertices, or as the shares of the second and third corner; of a
  // mesh that is turned inside out they are the third and second.
  enum class Mapping : std::uint8_t { vertices, corners, swapped_corners } mapping = Mapping::vertices;
  std::shared_ptr<const Texture> shine{};  // of lamps that are not alike all over: `radiance` is its mean
  // What its material asks of its mesh, by Texture::attribute: of vertices, or of triangles, from these on.
  struct Attribute {
    bool of_triangles = false;
    std::vector<Rgb> values;
  };
  std::vector<Attribute> attributes{};
  std::uint32_t first_vertex = 0, first_triangle = 0;
};
inline Rgb radiance_of(const Surface& surface, Uv uv) {
  return surface.shine ? eval(*surface.shine, {uv}) : surface.radiance;
}

// `normal`: for shading, interpolated; zero: the triangle's own, (p1 - p0) x (p2 - p0).
struct Vertex {
  Point at;
  Direction normal;
  Uv uv;
};
struct Triangle {
  std::array<std::uint32_t, 3> corner{};
  std::uint32_t surface = 0;
};
// Intersected in double precision. `axes`: of its longitudes and latitudes.
struct Sphere {
  Vec3<double> centre;
  double radius = 1;
  bool inwards = false;  // its normals
  LocalFrame<float> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::uint32_t surface = 0;
};
// Of a plane, centre + x s + y t: a rectangle where |x|, |y| <= 1, a disk where x^2 + y^2 <= 1 (or what a
// transform makes of them). Intersected in double precision. `normal`: along s x t or against it.
struct Flat {
  Vec3<double> centre, s, t;
  Direction normal{0, 0, 1};
  std::uint32_t surface = 0;
};

// Points base + x s + y t + z axis where x^2 + y^2 = 1 and 0 <= z <= 1, s, t and axis at right angles and s
// as long as t. Intersected in double precision.
struct Cylinder {
  Vec3<double> base, s, t, axis;
  bool inwards = false;  // its normals
  std::uint32_t surface = 0;
};

struct PointLight {
  Point at;
  Rgb intensity;
};
// From its place along the frame's n: full up to `beam`, then falling linearly to 0 at `cutoff`, both angles
// in radians. `picture`, if any, is seen through by (x, y) / z.
// A projector (tan_x, tan_y > 0) shines as a camera sees, which makes a wall before it evenly bright: its
// picture fills a rectangle of that half width and height at distance 1, and `cutoff` leads to its corners.
struct SpotLight {
  Point at;
  LocalFrame<float> frame;
  Rgb intensity;
  float beam = 0, cutoff = 0;
  std::optional<Texture> picture{};
  float tan_x = 0, tan_y = 0;
  // Towards a direction in which light goes.
  Rgb towards(Direction direction) const;
};
struct DirectionalLight {
  Direction direction;  // in which the light goes
  Rgb irradiance;       // of a surface that faces it
};

struct Camera {
  Point origin, left, up, forward;  // an orthonormal basis
  float tan_x = 1, tan_y = 1;       // half the picture's width and height at distance 1
  // What the picture shows lies so much to the right and below, in sizes of it.
  float shift_x = 0, shift_y = 0;
  float near = 0, far = std::numeric_limits<float>::infinity();  // along `forward`; the rest is not seen
  // Orthographic: all rays go `forward`, from a plane that `left` and `up` span, which need not be unit
  // vectors then, nor at right angles.
  bool parallel = false;
  float lens = 0, focus = 1;  // the lens's radius, and how far along `forward` the picture is sharp
};
// A ray of the camera, through (x, y) of the picture, both from 0 to 1, and a point of the unit disk on its lens.
struct CameraLine {
  Point origin;
  Direction direction;
};
inline CameraLine line_through(const Camera& c, float x, float y, Vec2<double> on_lens = {0, 0}) {
  const float px = 1 - 2 * (x + c.shift_x), py = 1 - 2 * (y + c.shift_y);
  if (c.parallel) return {c.origin + (px * c.tan_x) * c.left + (py * c.tan_y) * c.up, c.forward};
  const Direction towards = c.forward + (px * c.tan_x) * c.left + (py * c.tan_y) * c.up;
  if (!(c.lens > 0)) return {c.origin, normalize(towards)};
  const Direction from = (c.lens * float(on_lens.x)) * c.left + (c.lens * float(on_lens.y)) * c.up;
  return {c.origin + from, normalize(c.focus * towards - from)};
}

// What weighs a camera ray by its place about a pixel's centre.
struct Filter {
  enum class Kind { box, tent, gaussian } kind = Kind::box;
  float width = .5f;   // half the box, half the tent's base, the Gaussian's standard deviation; in pixels
  bool beyond = true;  // the film's border; otherwise nothing from there counts, as in Mitsuba by default
};

enum class Technique {
  balance,   // lights and the surface's own directions, weighed by the balance heuristic
  power,     // by the power heuristic, exponent 2
  light,     // lights alone; deltas still find them by chance
  surface,   // the surface's directions alone; point and directional lights stay dark
  resampled  // the surface's directions, resampled by the light that they see: direct lighting alone
};

// How light is to be computed.
struct Transport {
  enum class Method { path, direct, recursive, photons } method = Method::path;
  Technique technique = Technique::balance;
  int split = 0;  // directions at a hit, photons' gathering and direct light included; 0: the method's own
  struct Photons {
    int count = 0;           // of light paths per pass; 0: as many as pixels
    float radius = 0;        // within which the first pass looks for photons; 0: a few pixels wide
    float shrink = 2 / 3.f;  // alpha of the progressive radius; 1: it stays
    bool gather = true;      // final gathering: indirect light is looked up one bounce away
  } photons;
};

struct Scene {
  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<Sphere> spheres;
  std::vector<Flat> rectangles, disks;
  std::vector<Cylinder> cylinders;
  std::vector<Surface> surfaces;
  std::vector<PointLight> point_lights;
  std::vector<SpotLight> spot_lights;
  std::vector<DirectionalLight> directional_lights;
  std::optional<Environment> environment;
  Camera camera;
  Filter filter;
  int width = 0, height = 0, samples = 16;
  PointSet points;
  Transport transport;
  bool hide_lamps = false;  // from the camera, which sees what lies behind them; skies too
  int max_depth = 8;        // path edges, as in Mitsuba; -1: no limit
  int rr_depth = 5;
  std::vector<std::string> notes;  // what the reader has to say: words without effect
  std::uint64_t identity = 0;      // of the file and all that it names; 0: made in memory
};

struct SceneOptions {
  std::map<std::string, std::string> defines;  // $name
  std::string sampler = "one-shot";            // of reflectree::samplers(): "reflectree" and "measured"
  std::string adjoint = "";  // of light's side, for photons; "": the same and a cosine lobe, see sampled()
};

// Their names, in scenes and on the command line; "ldsampler", Mitsuba's word, is sobol.
std::optional<Transport::Method> method_of(std::string_view name);
std::optional<PointSet::Kind> points_of(std::string_view name);

// Throws Error, naming line and column.
Scene load_scene(const std::string& path, const SceneOptions& options = {}, const Host& host = {});
Scene parse_scene(std::string_view xml, const std::string& path, const SceneOptions& options = {},
                  const Host& host = {});

}  // namespace reflectree::render
