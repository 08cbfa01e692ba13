// SPDX-License-Identifier: Apache-2.0
// Step 2: how each domain lays an even grid of its square over the disk; a ring and a wedge are followed.
#include "figures.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/draw/square_image.hpp"
#include "reflectree/sampler/square/domain_map.hpp"

namespace reflectree::method {

using namespace draw;

namespace {

constexpr SquareCell ring_above{-1, 1, 0.5f, 0.625f}, ring_below{-1, 1, -0.625f, -0.5f},
    wedge{0.5f, 0.625f, 0, 1};

void split_evenly(std::vector<TreeSplit>& nodes, int levels) {
  nodes.push_back(levels == 0 ? TreeSplit::leaf : levels % 2 == 0 ? TreeSplit::x : TreeSplit::y);
  if (levels > 0) split_evenly(nodes, levels - 1), split_evenly(nodes, levels - 1);
}

// The image of a cell on the disk about (x, y).
std::string cell_image(const Domain& domain, Direction wo, const SquareCell& c, double x, double y,
                       double radius, std::string_view css_class) {
  PathData outline;
  constexpr int steps = 96;
  const auto edge = [&](Vec2<float> from, Vec2<float> to) {
    for (int k = 0; k < steps; ++k) {
      const float t = float(k) / steps;
      const Direction wi =
          lift(domain, wo, {linear_mix(t, from.x, to.x), linear_mix(t, from.y, to.y)}).geometry.wi;
      const double px = x + radius * double(wi.x), py = y - radius * double(wi.y);
      outline.empty() ? outline.move_to(px, py) : outline.line_to(px, py);
    }
  };
  edge({c.x0, c.y0}, {c.x1, c.y0}), edge({c.x1, c.y0}, {c.x1, c.y1});
  edge({c.x1, c.y1}, {c.x0, c.y1}), edge({c.x0, c.y1}, {c.x0, c.y0});
  outline.close();
  return path(outline, css_class);
}

}  // namespace

Figure domains_figure() {
  std::vector<TreeSplit> nodes;
  split_evenly(nodes, 8);  // 16 x 16
  const Direction wo = viewer_at(50 * pi / 180);
  const double radius = 104, width = 268, height = 280, x = width / 2, y = 146;
  std::vector<Figure> panels;

  Figure square{width, height, "square", {}, {}};
  square.body = label(x, 24, "the square", Anchor::middle, "head");
  const SquarePlace place{x - 86, y - 90, 184, false};
  square.body += cell_rectangle(ring_above, place, "ring-mark") +
                 cell_rectangle(ring_below, place, "ring-mark") + cell_rectangle(wedge, place, "wedge-mark");
  PathData grid;
  for (int i = 0; i <= 16; ++i) {
    const double at = i / 8.0 - 1;
    grid.move_to(place.px(at), place.py(-1));
    grid.line_to(place.px(at), place.py(1));
    grid.move_to(place.px(-1), place.py(at));
    grid.line_to(place.px(1), place.py(at));
  }
  square.body += path(grid, "cells") + line(place.px(-1), place.py(0), place.px(1), place.py(0), "pole") +
                 square_axes(place) + label(place.x - 6, place.py(-1), "rim", Anchor::end, "tick");
  square.body += label(x, height - 8, "16 × 16 cells; *y* < 0: the other side", Anchor::middle, "note");
  panels.push_back(square);

  // Strokes are light over dark: the density of the map, cells per projected solid angle, lies behind.
  const auto panel = [&](const Domain& domain, const std::string& note) {
    Figure figure{width, height, name_of(domain.kind), {}, {}};
    const DiskImage density = disk_image(
        [&](std::span<const Direction> wi, std::span<float> out) {
          for (std::size_t i = 0; i < wi.size(); ++i) {
            out[i] = 1 / lift(domain, wo, lower(domain, wo, wi[i])).projected_area;
          }
        },
        200);
    const Axis range{0.08, 40, 0, 1, true};
    std::string name = name_of(domain.kind);
    for (char& c : name) c = c == '_' ? ' ' : c;
    figure.body = label(x, 24, name, Anchor::middle, "head");
    figure.body += disk_raster(density, range, x, y, 2 * radius);
    figure.body += cell_image(domain, wo, ring_above, x, y, radius, "ring-mark");
    figure.body += cell_image(domain, wo, ring_below, x, y, radius, "ring-mark");
    figure.body += cell_image(domain, wo, wedge, x, y, radius, "wedge-mark");
    figure.body += cell_borders(nodes, domain, wo, x, y, radius, density, range);
    figure.body += circle(x, y, radius, "rim");
    const bool uses_wo = domain.kind == DomainKind::half_vector || domain.kind == DomainKind::back_vector;
    if (uses_wo) {
      const double mark = x + radius * double(wo.x);
      figure.body += circle(mark, y, 3.5, "mark-edge") + circle(mark, y, 3.5, "mark");
    }
    figure.body += label(x, height - 8, note, Anchor::middle, "note");
    panels.push_back(figure);
  };
  panel({DomainKind::projected_disk, Symmetry::none, 0}, "*y* = sin² *θ*_i");
  panel({DomainKind::equal_area, Symmetry::none, 0}, "*y* = 1 − cos *θ*_i");
  panel({DomainKind::half_vector, Symmetry::none, 0}, "the pole is the mirror direction");
  panel({DomainKind::back_vector, Symmetry::none, 0}, "the pole is the viewer");
  panel({DomainKind::stretched, Symmetry::none, 1.5f}, "*a* = 1.5: cells gather at the rim");
  return side_by_side(
      "Domains",
      "A polar square of 16 by 16 even cells and its images on the disk under the five "
      "domains, for a viewer at 50 degrees; a ring of constant radius and a wedge of constant "
      "azimuth are marked.",
      panels, 3, 10);
}

}  // namespace reflectree::method
