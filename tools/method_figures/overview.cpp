// SPDX-License-Identifier: Apache-2.0
// The method in one picture: a function, its tree of bounds, directions, and their density.
#include <algorithm>

#include "figures.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/draw/svg.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/sampler.hpp"

namespace reflectree::method {

using namespace draw;

Figure overview_figure(const Example& example) {
  constexpr std::size_t n = 400000, shown = 3000;
  constexpr double width = 250, height = 296, x = width / 2, y = 170, radius = 112;
  const Sampler<AnyBrdf> sampler = make_sampler(example.f, example.data);
  const Direction wo = example.wo;
  std::vector<Direction> samples;
  Pcg32 random(1);
  for (std::size_t i = 0; i < n; ++i) {
    if (const auto s = sampler.exact.sample(wo, random)) samples.push_back(s->wi);
  }
  std::vector<Figure> panels;
  const auto panel = [&](const char* title, const std::string& note, const std::string& body) {
    Figure figure{width, height, title, {}, {}};
    figure.body = label(x, 24, title, Anchor::middle, "head") + label(x, 44, note, Anchor::middle, "aside");
    figure.body += body;
    if (!panels.empty()) {  // an arrow from the panel before
      PathData arrow;
      arrow.move_to(-7, y - 7);
      arrow.line_to(0, y);
      arrow.line_to(-7, y + 7);
      figure.body += path(arrow, "axis");
    }
    panels.push_back(figure);
  };

  const DiskImage target = target_image(example.f, example.data.target, wo);
  const Axis range = log_range(target);
  const std::string rim = circle(x, y, radius, "rim");
  const double viewer = x + radius * double(wo.x);
  const std::string mark = circle(viewer, y, 4.5, "mark-edge") + circle(viewer, y, 4.5, "mark") +
                           label(viewer, y - 13, "*ω*_o", Anchor::middle, "over");
  panel("Any function", "its values over all *ω*_i",
        disk_raster(target, range, x, y, 2 * radius) + rim + mark);

  const MajorantTree& tree = example.data.exact.at(slab_of(example.data.exact_partition, wo));
  const DiskImage bound = bound_image(example.data, wo);
  panel("A tree of bounds", std::to_string(tree.mass.size()) + " leaves, nothing to tune",
        disk_raster(bound, range, x, y, 2 * radius) +
            cell_borders(tree.nodes, example.data.domain, wo, x, y, radius, bound, range) + rim);

  PathData dots;
  for (std::size_t i = 0; i < std::min(shown, samples.size()); ++i) {
    dots.dot(x + radius * double(samples[i].x), y - radius * double(samples[i].y));
  }
  panel("Directions", number(double(tree.volume), 2) + " trials for each",
        disk_raster(target, range, x, y, 2 * radius, "pale") + path(dots, "dots") + rim);

  const PlaneLobe lobe =
      plane_lobe(example.f, example.data.target, wo, double(albedo_at(example.data.albedo, wo.z)));
  const PlaneHistogram histogram = plane_histogram(samples);
  double expected = 0, highest = 0;
  for (const double d : lobe.density) expected += d / histogram.density_per_count();
  const std::vector<PlaneBar> bars = plane_bars(histogram, lobe, expected / 90);
  for (const double d : lobe.density) highest = std::max(highest, d);
  for (const PlaneBar& b : bars) highest = std::max(highest, b.count * b.density_per_count);
  panel("Exactly its density", "400 000 samples (bars) and function",
        polar_plot(lobe, bars, wo, highest, x, y + 60, radius - 14));

  return side_by_side(
      "From a function to directions",
      "A reflectance function over the disk of light directions; the tree of bounds built from it; "
      "directions "
      "drawn under the bounds and kept in proportion; and their histogram in the plane of incidence, which "
      "follows the function.",
      panels, 4, 0);
}

}  // namespace reflectree::method
