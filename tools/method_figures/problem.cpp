// SPDX-License-Identifier: Apache-2.0
// Step 1: the same number of directions by three samplers, and the variance that each leaves.
#include <cmath>
#include <functional>

#include "figures.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/draw/svg.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/math/square_maps.hpp"
#include "reflectree/sampler/sampler.hpp"

namespace reflectree::method {

using namespace draw;

namespace {

struct Drawn {
  std::vector<Direction> wi;
  double sum = 0, squares = 0;  // of t cos / pdf
  void add(Direction w, double weight) {
    wi.push_back(w);
    sum += weight;
    squares += weight * weight;
  }
  double relative_variance() const {
    const double n = double(wi.size());
    return squares * n / (sum * sum) - 1;
  }
};

}  // namespace

Figure problem_figure(const Example& example) {
  constexpr std::size_t n = 200000, shown = 700;
  const Sampler<AnyBrdf> sampler = make_sampler(example.f, example.data);
  const auto t_cos = [&](Direction wi) {
    const Spectrum value = example.f(shading_geometry(example.wo, wi));
    return double(example.data.target(value) * wi.z);
  };
  Drawn uniform, cosine, exact;
  Pcg32 random(2008);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2<float> p{2 * to_unit_float(random()) - 1, 2 * to_unit_float(random()) - 1};
    const Direction u = disk_to_hemisphere_equal_area(square_to_disk(p));
    const Direction c = disk_to_hemisphere_projected(square_to_disk(p));
    if (u.z > 0) uniform.add(u, t_cos(u) * 2 * pi_v<double>);
    if (c.z > 0) cosine.add(c, t_cos(c) / double(c.z) * pi_v<double>);
    if (const auto s = sampler.exact.sample(example.wo, random))
      exact.add(s->wi, t_cos(s->wi) / double(s->pdf));
  }
  const DiskImage target = target_image(example.f, example.data.target, example.wo, 200);
  const Axis range = log_range(target);
  const double radius = 118, width = 268;
  std::vector<Figure> panels;
  const auto panel = [&](const char* title, const Drawn& drawn) {
    Figure figure{width, 316, title, {}, {}};
    const double x = width / 2, y = 164;
    figure.body = label(x, 24, title, Anchor::middle, "head");
    figure.body += disk_raster(target, range, x, y, 2 * radius, "pale");
    PathData dots;
    for (std::size_t i = 0; i < shown; ++i) {
      dots.dot(x + radius * double(drawn.wi[i].x), y - radius * double(drawn.wi[i].y));
    }
    figure.body += path(dots, "dots") + circle(x, y, radius, "rim");
    const double variance = drawn.relative_variance();
    figure.body += label(x, 304, "relative variance " + (variance < 1e-4 ? "< 10⁻⁴" : number(variance, 2)),
                         Anchor::middle, "label");
    panels.push_back(figure);
  };
  panel("uniform directions", uniform);
  panel("cosine", cosine);
  panel("exact", exact);
  return side_by_side(
      "Three ways to choose directions",
      "700 directions each, uniform, by cosine and exact, over the target of the material seen at 50 "
      "degrees. "
      "Only the exact ones gather where the target is bright; their weights have no variance.",
      panels, 3, 4);
}

}  // namespace reflectree::method
