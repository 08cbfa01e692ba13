// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/path_tracer.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/math/frame.hpp"
#include "reflectree/render/embree_scene.hpp"

namespace reflectree::render {

namespace {

Direction normal_of(const Scene& s, const Triangle& t, float* area = nullptr) {
  const Point a = s.points[t.corner[0]];
  const Point n = cross(s.points[t.corner[1]] - a, s.points[t.corner[2]] - a);
  const float size = length(n);
  if (area) *area = size / 2;
  return (1 / size) * n;
}

float sum(Rgb c) { return c.r + c.g + c.b; }

// Emitting triangles, chosen in proportion to their power.
struct Lights {
  std::vector<std::uint32_t> triangle;
  std::vector<double> cdf;
  std::vector<float> per_area;  // a triangle of the scene: density of its points, per area

  explicit Lights(const Scene& scene) : per_area(scene.triangles.size()) {
    double total = 0;
    for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) {
      const Triangle& t = scene.triangles[i];
      float area = 0;
      normal_of(scene, t, &area);
      if (!(sum(t.radiance) > 0)) continue;
      triangle.push_back(i), cdf.push_back(total += double(area * sum(t.radiance)));
    }
    for (const std::uint32_t i : triangle) per_area[i] = sum(scene.triangles[i].radiance) / float(total);
  }
};

struct Tracer {
  const Scene& scene;
  EmbreeScene embree{scene};
  Lights lights{scene};
  float near = 1e-4f;  // of the scene's extent: rays start this far from surfaces

  explicit Tracer(const Scene& s) : scene(s) {
    float extent = 0;
    for (const Point p : s.points)
      extent = max(extent, max(std::abs(p.x), max(std::abs(p.y), std::abs(p.z))));
    near *= max(extent, 1e-3f);
  }

  static Rgb value(const Surface& s, Direction wo, Direction wi) {
    if (!(wo.z > 0 && wi.z > 0)) return {};
    return s.f ? to_rgb(eval(*s.f, wo, wi)) : (1 / pi) * s.albedo;
  }
  static float pdf(const Surface& s, Direction wo, Direction wi) {
    if (!(wo.z > 0 && wi.z > 0)) return 0;
    return s.sampler ? s.sampler->pdf(wo, wi) : wi.z / pi;
  }
  static std::optional<DirectionSample<Rgb>> sample(const Surface& s, Direction wo, Pcg32& u) {
    if (!(wo.z > 0)) return std::nullopt;
    if (s.sampler) {
      const auto drawn = s.sampler->sample(wo, u);
      if (!drawn) return std::nullopt;
      return DirectionSample<Rgb>{drawn->wi, drawn->pdf, to_rgb(drawn->weight), drawn->flags};
    }
    const float r2 = to_unit_float(u()), phi = 2 * pi * to_unit_float(u()), r = sqrt(r2);
    const Direction wi{r * cos(phi), r * sin(phi), sqrt(1 - r2)};
    return DirectionSample<Rgb>{wi, wi.z / pi, s.albedo, sample_reflection};
  }

  // Next-event estimation: a point on a light, weighted against the directions that the surface would draw.
  Rgb direct(Point at, const Frame<float>& frame, Direction wo, const Surface& surface, Pcg32& u) const {
    if (lights.triangle.empty()) return {};
    const double pick = to_unit_double(u()) * lights.cdf.back();
    const auto chosen = std::upper_bound(lights.cdf.begin(), lights.cdf.end() - 1, pick) - lights.cdf.begin();
    const std::uint32_t index = lights.triangle[std::size_t(chosen)];
    const Triangle& light = scene.triangles[index];
    const float root = sqrt(to_unit_float(u())), b2 = root * to_unit_float(u());
    const Point on = (1 - root) * scene.points[light.corner[0]] +
                     (root - b2) * scene.points[light.corner[1]] + b2 * scene.points[light.corner[2]];
    const float distance = length(on - at);
    if (!(distance > near)) return {};
    const Direction to_light = (1 / distance) * (on - at), wi = to_local(frame, to_light);
    const float cosine = -dot(normal_of(scene, light), to_light);
    const Rgb f = value(surface, wo, wi);
    if (!(cosine > 0) || !(sum(f) > 0)) return {};
    const float density = lights.per_area[index] * distance * distance / cosine;
    const bool competes = !surface.sampler || surface.sampler->has_pdf();
    if (embree.occluded(at, to_light, near, distance - near)) return {};
    return (wi.z / (density + (competes ? pdf(surface, wo, wi) : 0.f))) * (f * light.radiance);
  }

  // `depth` counts edges: 1 is what the camera sees directly.
  Rgb radiance(Point origin, Direction direction, Pcg32& u) const {
    Rgb result, throughput{1, 1, 1};
    float drawn_pdf = -1;  // of the direction; negative: nothing competes with it
    for (int depth = 1; scene.max_depth < 0 || depth <= scene.max_depth; ++depth) {
      const auto hit = embree.intersect(origin, direction, depth == 1 ? 0 : near);
      if (!hit) return result + throughput * scene.sky;
      const Triangle& triangle = scene.triangles[hit->triangle];
      Direction normal = normal_of(scene, triangle);
      const float cosine = -dot(normal, direction);
      if (cosine > 0 && sum(triangle.radiance) > 0) {
        const float other = lights.per_area[hit->triangle] * hit->distance * hit->distance / cosine;
        result =
            result + (drawn_pdf < 0 ? 1 : drawn_pdf / (drawn_pdf + other)) * (throughput * triangle.radiance);
      }
      if (depth == scene.max_depth) return result;
      const Surface& surface = scene.surfaces[triangle.surface];
      if (surface.two_sided && cosine < 0) normal = -normal;
      const Frame<float> frame = frame_from_normal(normal);
      const Direction wo = to_local(frame, -direction);
      const Point at = origin + hit->distance * direction;
      // A method without a density cannot be weighed: lights are left to its own directions alone.
      const bool competes = !surface.sampler || surface.sampler->has_pdf();
      if (competes) result = result + throughput * direct(at, frame, wo, surface, u);
      const auto next = sample(surface, wo, u);
      if (!next) return result;
      throughput = throughput * next->weight;
      drawn_pdf = competes ? next->pdf : -1;
      origin = at, direction = normalize(to_world(frame, next->wi));
      if (depth >= scene.rr_depth) {  // Russian roulette by the largest channel
        const float survive = std::min(.95f, std::max({throughput.r, throughput.g, throughput.b}));
        if (!(to_unit_float(u()) < survive)) return result;
        throughput = (1 / survive) * throughput;
      }
    }
    return result;
  }
};

}  // namespace

Image render(const Scene& scene, const RenderOptions& options, const Host& host) {
  const Tracer tracer(scene);
  const int samples = options.samples > 0 ? options.samples : scene.samples;
  Image image = make_image(scene.width, scene.height, {"R", "G", "B", "stderr.R", "stderr.G", "stderr.B"});
  image.metadata = {{"samples", std::to_string(samples)}, {"seed", std::to_string(options.seed)}};
  std::atomic<int> rows = 0;
  host.parallel_for(std::size_t(scene.height), [&](std::size_t begin, std::size_t end) {
    for (int y = int(begin); y < int(end); ++y) {
      if (host.cancelled()) throw Cancelled();
      for (int x = 0; x < scene.width; ++x) {
        double total[3] = {}, squares[3] = {};
        for (int s = 0; s < samples; ++s) {
          Pcg32 u(options.seed * 0x9e3779b97f4a7c15ULL + std::uint64_t(s),
                  std::uint64_t(y) * std::uint64_t(scene.width) + std::uint64_t(x));
          const float px = 1 - 2 * (float(x) + to_unit_float(u())) / float(scene.width);
          const float py = 1 - 2 * (float(y) + to_unit_float(u())) / float(scene.height);
          const Camera& c = scene.camera;
          const Direction d = normalize(c.forward + (px * c.tan_x) * c.left + (py * c.tan_y) * c.up);
          const Rgb v = tracer.radiance(c.origin, d, u);
          for (int k = 0; k < 3; ++k) {
            total[k] += double(channel(v, k)), squares[k] += double(channel(v, k)) * double(channel(v, k));
          }
        }
        float* out = image.values.data() + image.index(x, y);
        const double n = samples;
        for (int k = 0; k < 3; ++k) {
          const double mean = total[k] / n;
          out[k] = float(mean);
          out[k + 3] = float(std::sqrt(std::max(0., squares[k] / n - mean * mean) / std::max(1., n - 1)));
        }
      }
      host.progress(float(++rows) / float(scene.height));
    }
  });
  return image;
}

}  // namespace reflectree::render
