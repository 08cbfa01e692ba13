// SPDX-License-Identifier: Apache-2.0
// A path tracer in a hundred lines: a sphere on a floor under a sky, both covered by samplers of ours. The
// scene is that of examples/python/path_tracer.py.
//
// Usage: path_tracer [WIDTH [SAMPLES [FILE.ppm]]]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <reflectree/brdf/models/plastic.hpp>
#include <reflectree/math/frame.hpp>
#include <reflectree/sampler/sampler.hpp>

using namespace reflectree;

namespace {

constexpr int bounces = 4;
const Direction centre{0, 0, 1};  // of a sphere of radius 1

Rgb sky(Direction d) {
  const float up = 0.3f + 0.5f * std::max(d.z, 0.f);
  const Rgb blue{0.7f * up, 0.85f * up, up};
  const bool sun = dot(d, Direction{0.48f, -0.6f, 0.64f}) > std::cos(7.5f * pi / 180);
  return sun ? blue + Rgb{12, 10.8f, 8.4f} : blue;
}

struct Hit {
  float t = INFINITY;
  Direction normal{0, 0, 1};
  bool sphere = false;
};

Hit intersect(Direction o, Direction d) {
  Hit hit;
  const Direction from = o - centre;
  const float b = dot(from, d), root = b * b - (dot(from, from) - 1);
  const float near = root > 0 ? -b - std::sqrt(root) : INFINITY;
  if (near > 1e-3f && near < INFINITY) hit = {near, normalize(from + near * d), true};
  const float floor = d.z < 0 ? -o.z / d.z : INFINITY;
  if (floor > 1e-3f && floor < hit.t) hit = {floor, {0, 0, 1}, false};
  return hit;
}

// The radiance that comes along a ray. The sampler's weight holds f, the cosine and the density.
template <class Ball, class Floor>
Rgb radiance(const Sampler<Ball>& ball, const Sampler<Floor>& floor, Direction o, Direction d,
             Pcg32& random) {
  Rgb weight{1, 1, 1};
  for (int k = 0; k <= bounces; ++k) {
    const Hit hit = intersect(o, d);
    if (hit.t == INFINITY) return weight * sky(d);
    const LocalFrame<float> frame = frame_from_normal(hit.normal);
    const Direction wo = to_local(frame, -1.f * d);
    Direction wi;
    if (hit.sphere) {
      const auto drawn = ball.exact.sample(wo, random);
      if (!drawn) return {};
      wi = drawn->wi, weight = weight * drawn->weight;
    } else {
      const auto drawn = floor.exact.sample(wo, random);
      if (!drawn) return {};
      wi = drawn->wi, weight = drawn->weight * weight;
    }
    o = o + hit.t * d + 1e-4f * hit.normal;
    d = normalize(to_world(frame, wi));
  }
  return {};  // what more bounces would bring is left out
}

}  // namespace

int main(int argc, char** argv) {
  const int width = argc > 1 ? std::atoi(argv[1]) : 48, samples = argc > 2 ? std::atoi(argv[2]) : 16;
  if (width < 1 || width > 8192 || samples < 1) {
    std::fprintf(stderr, "usage: path_tracer [WIDTH [SAMPLES [FILE.ppm]]]\n");
    return 2;
  }
  const int height = width * 2 / 3;
  Plastic plastic;
  plastic.alpha = 0.1f;
  const auto ball = make_sampler(plastic);
  const auto floor = make_sampler([](Direction, Direction) { return 0.5f / pi; });
  Pcg32 random(1);
  std::vector<Rgb> picture(std::size_t(width) * std::size_t(height));
  double mean = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    for (int s = 0; s < samples; ++s) {
      const float x = (float(i % std::size_t(width)) + to_unit_float(random())) / float(width);
      const float y = (float(i / std::size_t(width)) + to_unit_float(random())) / float(width);
      const Direction d = normalize(Direction{x - 0.5f, 1.2f, float(height) / float(width) / 2 - y - 0.1f});
      picture[i] = picture[i] + (1.f / float(samples)) * radiance(ball, floor, {0, -4, 1.4f}, d, random);
    }
    mean += double(picture[i].r + picture[i].g + picture[i].b) / 3 / double(picture.size());
  }
  std::printf("%d x %d, %d samples per pixel: mean %.3f\n", width, height, samples, mean);
  if (argc > 3) {
    std::ofstream file(argv[3], std::ios::binary);
    file << "P6 " << width << " " << height << " 255\n";
    for (const Rgb& p : picture)
      for (const float x : {p.r, p.g, p.b}) file.put(char(255 * std::pow(std::clamp(x, 0.f, 1.f), 1 / 2.2f)));
  }
}
