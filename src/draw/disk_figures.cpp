// SPDX-License-Identifier: Apache-2.0
// The pictures over the disk.
#include <algorithm>
#include <cmath>

#include "disk_frame.hpp"
#include "reflectree/draw/material_figures.hpp"

namespace reflectree::draw {

namespace {

Figure disk_figure(const std::string& title, Direction wo) {
  Figure figure{disk_figure_width, disk_figure_height, title, {}, {}};
  figure.body = disk_heading(title, wo);
  return figure;
}

std::string bar_below(const DiskPlace& place, Axis range, const std::string& title) {
  range.from = place.x - place.radius;
  range.to = place.x + place.radius;
  return colour_bar({range, place.y + place.radius + 22, 8, title});
}

std::string angle_words(Direction wo) {
  return number(double(theta_of(wo)) * 180 / pi_v<double>, 3) + " degrees";
}

}  // namespace

Figure target_figure(const DiskImage& target, Direction wo) {
  const DiskPlace place;
  const Axis range = log_range(target);
  Figure figure = disk_figure("Target", wo);
  figure.description =
      "The reflectance that is sampled, over the projected disk of light directions, for a view at " +
      angle_words(wo) + "; colours from " + pretty(range.lo) + " to " + pretty(range.hi) +
      " per steradian on a log scale.";
  figure.body += disk_raster(target, range, place.x, place.y, 2 * place.radius);
  figure.body += disk_overlay(place, wo, DiskMarks::light_with_rings);
  figure.body += bar_below(place, range, "target *t*(*ω*_o, *ω*_i) / sr⁻¹");
  return figure;
}

Figure tree_figure(const SamplerData& data, Direction wo, const Axis& range) {
  const DiskPlace place;
  const std::size_t slab = slab_of(data.exact_partition, wo);
  const MajorantTree& tree = data.exact.at(slab);
  const std::string leaves = pretty(double(tree.mass.size()), 6);
  const SlabBox box = slab_boxes(data.exact_partition).at(slab);
  const auto degrees = [](float radians) { return number(double(radians) * 180 / pi_v<double>, 2) + "°"; };
  Figure figure = disk_figure("Tree of " + leaves + " leaves", wo);
  figure.description =
      "The leaves of the exact-mode tree over the disk, coloured by their bound on the target, for a view "
      "at " +
      angle_words(wo) + "; domain " + name_of(data.domain.kind) + ", slab from " + degrees(box.lo[0]) +
      " to " + degrees(box.hi[0]) + ".";
  const DiskImage bound = bound_image(data, wo);
  figure.body += disk_raster(bound, range, place.x, place.y, 2 * place.radius);
  figure.body += cell_borders(tree.nodes, data.domain, wo, place.x, place.y, place.radius, bound, range);
  figure.body += disk_overlay(place, wo, DiskMarks::light);
  figure.body += bar_below(
      place, range, "bound on *t* / sr⁻¹, slab *θ*_o = " + degrees(box.lo[0]) + " to " + degrees(box.hi[0]));
  return figure;
}

Figure samples_figure(const DiskImage& target, Direction wo, std::span<const Direction> samples,
                      std::size_t shown) {
  const DiskPlace place;
  const std::size_t n = std::min(shown, samples.size());
  Figure figure = disk_figure(pretty(double(n), 6) + " samples", wo);
  figure.description = "Sampled light directions as dots over the paled target, for a view at " +
                       angle_words(wo) + ": dots are dense where the target is bright.";
  const Axis range = log_range(target);
  figure.body += disk_raster(target, range, place.x, place.y, 2 * place.radius, "pale");
  PathData dots;
  for (const Direction& wi : samples.first(n)) dots.dot(place.px(double(wi.x)), place.py(double(wi.y)));
  figure.body += path(dots, "dots");
  figure.body += disk_overlay(place, wo, DiskMarks::ink);
  figure.body += bar_below(place, range, "dots per area ∝ *t*(*ω*_o, *ω*_i); behind them *t* / sr⁻¹");
  return figure;
}

Figure thumbnail_figure(const AnyBrdf& f, const Target& target, Direction wo) {
  const DiskImage image = target_image(f, target, wo, 96);
  Figure figure{64, 64, "Target", "The target over the disk, seen at " + angle_words(wo) + ".", {}};
  figure.body = disk_raster(image, log_range(image), 32, 32, 62) + circle(32, 32, 31, "rim");
  return figure;
}

}  // namespace reflectree::draw
