// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/film/film.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <string>

#include "materials/visible_slope.hpp"
#include "reading/fnv.hpp"
#include "reflectree/error.hpp"
#include "shapes/flat.hpp"

namespace reflectree::render {

namespace {

// Offsets from the pixel's centre are drawn from the filter, so that every sample counts alike: its
// distribution inverted, for points that are stratified.
Vec2<float> offset(Filter filter, PathBits& u) {
  const float a = to_unit_float(u()), b = to_unit_float(u());
  const auto tent = [](float x) { return x < .5f ? std::sqrt(2 * x) - 1 : 1 - std::sqrt(2 - 2 * x); };
  switch (filter.kind) {
    case Filter::Kind::box:
      return {filter.width * (2 * a - 1), filter.width * (2 * b - 1)};
    case Filter::Kind::tent:
      return {filter.width * tent(a), filter.width * tent(b)};
    case Filter::Kind::gaussian:
      break;
  }
  // Box & Muller; beyond four deviations, exp(-8) of the mass, the filter ends.
  const float r = filter.width * std::sqrt(-2 * std::log(1 - a * (1 - std::exp(-8.f))));
  return {r * std::cos(2 * pi * b), r * std::sin(2 * pi * b)};
}

// How far a filter reaches.
float reach(Filter f) { return f.kind == Filter::Kind::gaussian ? 4 * f.width : f.width; }

// One coordinate of an offset, from the filter's part between two ends, by its distribution and the inverse.
float offset_between(Filter f, float low, float high, float u) {
  low = std::max(low, -reach(f)) / f.width, high = std::min(high, reach(f)) / f.width;
  const auto tent = [](float x) { return x < 0 ? (1 + x) * (1 + x) / 2 : 1 - (1 - x) * (1 - x) / 2; };
  const float root_half = std::sqrt(.5f);
  switch (f.kind) {
    case Filter::Kind::box:
      return f.width * std::lerp(low, high, u);
    case Filter::Kind::tent: {
      const float share = std::lerp(tent(low), tent(high), u);
      return f.width * (share < .5f ? std::sqrt(2 * share) - 1 : 1 - std::sqrt(2 - 2 * share));
    }
    case Filter::Kind::gaussian:
      break;
  }
  return f.width / root_half *
         inverse_erf(std::lerp(std::erf(low * root_half), std::erf(high * root_half), u));
}

// Of pixel (x, y); nothing from beyond the film's border unless the filter takes it.
Vec2<float> offset(const Scene& s, int x, int y, PathBits& u) {
  const float r = reach(s.filter), left = float(x) + .5f, right = float(s.width) - left, top = float(y) + .5f,
              bottom = float(s.height) - top;
  if (s.filter.beyond || std::min({left, right, top, bottom}) >= r) return offset(s.filter, u);
  const float a = to_unit_float(u()), b = to_unit_float(u());
  return {offset_between(s.filter, -left, right, a), offset_between(s.filter, -top, bottom, b)};
}

// As many strata as there are to be samples, or fewer.
PointSet points_for(PointSet set, int samples) {
  const auto n = std::uint32_t(samples);
  set.columns = std::max(1U, std::uint32_t(std::sqrt(double(n))));
  set.rows = std::max(1U, n / set.columns);
  return set;
}

std::uint64_t identity_of(const Scene& s, const RenderOptions& o) {
  const Transport& t = s.transport;
  std::uint64_t h = fnv(std::to_string(s.identity), fnv_start);
  for (const double v :
       {double(s.width), double(s.height), double(s.max_depth), double(s.rr_depth), double(s.points.kind),
        double(t.method), double(t.split), double(t.photons.count), double(t.photons.radius),
        double(t.photons.shrink), double(t.photons.gather), double(o.technique.value_or(t.technique))}) {
    h = fnv(std::to_string(v), h);
  }
  return fnv(std::to_string(o.seed), h);
}

// Pixels that are rendered together, a sample of each at a time: what meets in packets of rays depends
// on nothing else.
constexpr int tile_size = 32;
struct Tile {
  int x0, y0, x1, y1;
};
std::size_t tiles_across(int n) { return std::size_t((n + tile_size - 1) / tile_size); }
Tile tile_of(const Scene& scene, std::size_t i) {
  const std::size_t across = tiles_across(scene.width);
  const int x = int(i % across) * tile_size, y = int(i / across) * tile_size;
  return {x, y, std::min(x + tile_size, scene.width), std::min(y + tile_size, scene.height)};
}

void add_sample(const Integrator& integrator, const Scene& scene, const Tile& tile, int sample, Film& film) {
  std::vector<CameraRay> rays;
  rays.reserve(std::size_t(tile_size) * tile_size);
  const auto pixel = [&](int x, int y) { return std::size_t(y) * std::size_t(scene.width) + std::size_t(x); };
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      PathBits u(film.points, film.seed, pixel(x, y), std::uint32_t(sample));
      const Vec2<float> off = offset(scene, x, y, u);
      const Camera& c = scene.camera;
      const CameraLine line = line_through(c, (float(x) + .5f + off.x) / float(scene.width),
                                           (float(y) + .5f + off.y) / float(scene.height),
                                           c.lens > 0 ? in_disk(u) : Vec2<double>{});
      rays.push_back({line.origin, line.direction, u});
    }
  }
  std::vector<Rgb> found(rays.size());
  integrator.radiance(rays, found);
  std::size_t n = 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x, ++n) {
      double* sums = film.sums.data() + 6 * pixel(x, y);
      const double values[] = {double(found[n].r), double(found[n].g), double(found[n].b)};
      for (int k = 0; k < 3; ++k) sums[k] += values[k], sums[k + 3] += values[k] * values[k];
    }
  }
}

}  // namespace

bool render_into(Film& film, const Scene& scene, const RenderOptions& options, const Host& host) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const auto integrator = make_integrator(scene, options.technique.value_or(scene.transport.technique));
  const bool timed = options.seconds > 0;
  const int goal = timed ? (1 << 30) : options.samples > 0 ? options.samples : scene.samples;
  const std::uint64_t identity = identity_of(scene, options);
  if (film.sums.empty()) {
    const PointSet points = points_for(scene.points, timed ? 16 : goal);
    film = {scene.width, scene.height, 0, options.seed, points, identity, {}};
    film.sums.resize(6 * std::size_t(scene.width) * std::size_t(scene.height));
  }
  if (film.identity != identity) {
    throw Error("the film is of another scene, seed or technique", "--resume",
                "give what it was begun with, or render anew");
  }
  const int first = film.samples;
  while (film.samples < goal && !(timed && film.samples > first && elapsed() >= options.seconds)) {
    const int pass = std::min(timed ? 1 : integrator->longest_pass(), goal - film.samples);
    Film next = film;
    const std::size_t tiles = tiles_across(scene.width) * tiles_across(scene.height);
    std::atomic<int> ready = 0;
    std::atomic<bool> stopped = false;
    const auto render_tiles = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && !stopped; ++i) {
        const Tile tile = tile_of(scene, i);
        for (int s = film.samples; s < film.samples + pass && !stopped; ++s) {
          if (host.cancelled()) stopped = true;
          if (!stopped) add_sample(*integrator, scene, tile, s, next);
        }
        const float done = float(film.samples - first) + float(pass) * float(++ready) / float(tiles);
        host.progress(timed ? float(elapsed() / options.seconds) : done / float(goal - first));
      }
    };
    try {
      integrator->prepare(film.samples, film.seed, host);
      host.parallel_for(tiles, render_tiles);
    } catch (const Cancelled&) {
      stopped = true;
    }
    if (stopped) return false;
    next.samples += pass;
    film = std::move(next);
  }
  return true;
}

Image to_image(const Film& film) {
  Image image = make_image(film.width, film.height, {"R", "G", "B", "stderr.R", "stderr.G", "stderr.B"});
  image.metadata = {{"samples", std::to_string(film.samples)}, {"seed", std::to_string(film.seed)}};
  const double n = std::max(1, film.samples);
  for (std::size_t i = 0; i < film.sums.size(); i += 6) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double mean = film.sums[i + k] / n, square = film.sums[i + k + 3] / n;
      image.values[i + k] = float(mean);
      image.values[i + k + 3] = float(std::sqrt(std::max(0., square - mean * mean) / std::max(1., n - 1)));
    }
  }
  return image;
}

Image render(const Scene& scene, const RenderOptions& options, const Host& host) {
  Film film;
  if (!render_into(film, scene, options, host)) throw Cancelled();
  return to_image(film);
}

}  // namespace reflectree::render
