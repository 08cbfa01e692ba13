// SPDX-License-Identifier: Apache-2.0
// Step 2: how each domain lays an even grid of its square over the disk.
#include "figures.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/draw/svg.hpp"
#include "reflectree/sampler/domain_map.hpp"

namespace reflectree::method {

using namespace draw;

namespace {

void split_evenly(std::vector<Split>& nodes, int levels) {
  nodes.push_back(levels == 0 ? Split::leaf : levels % 2 == 0 ? Split::x : Split::y);
  if (levels > 0) split_evenly(nodes, levels - 1), split_evenly(nodes, levels - 1);
}

}  // namespace

Figure domains_figure() {
  std::vector<Split> nodes;
  split_evenly(nodes, 8);  // 16 x 16
  const Direction wo = viewer_at(50 * pi / 180);
  const double radius = 84, width = 196, height = 232;
  std::vector<Figure> panels;

  Figure square{width, height, "square", {}, {}};
  square.body = label(width / 2, 22, "the square", Anchor::middle, "head");
  PathData grid;
  for (int i = 0; i <= 16; ++i) {
    const double s = 75, x = width / 2, y = 124, at = -s + 2 * s * i / 16;
    grid.move_to(x + at, y - s);
    grid.line_to(x + at, y + s);
    grid.move_to(x - s, y + at);
    grid.line_to(x + s, y + at);
  }
  square.body += path(grid, "cells") + label(width / 2, 226, "16 × 16 cells", Anchor::middle, "note");
  panels.push_back(square);

  // Strokes are light over dark: the density of the map, cells per projected solid angle, lies behind.
  const auto panel = [&](const Domain& domain, const std::string& note) {
    Figure figure{width, height, name_of(domain.kind), {}, {}};
    const double x = width / 2, y = 124;
    const DiskImage density = disk_image(
        [&](std::span<const Direction> wi, std::span<float> out) {
          for (std::size_t i = 0; i < wi.size(); ++i) {
            const float area = lift(domain, wo, lower(domain, wo, wi[i])).projected_area;
            out[i] = area > 0 ? 1 / area : 0.f;
          }
        },
        160);
    const Axis range{0.08, 40, 0, 1, true};
    std::string name = name_of(domain.kind);
    for (char& c : name) c = c == '_' ? ' ' : c;
    figure.body = label(x, 22, name, Anchor::middle, "head");
    figure.body += disk_raster(density, range, x, y, 2 * radius);
    figure.body += cell_borders(nodes, domain, wo, x, y, radius, density, range);
    figure.body += circle(x, y, radius, "rim");
    const bool uses_wo = domain.kind == DomainKind::half_vector || domain.kind == DomainKind::back_vector;
    if (uses_wo) {
      const double mark = x + radius * double(wo.x);
      figure.body += circle(mark, y, 3.5, "mark-edge") + circle(mark, y, 3.5, "mark");
    }
    figure.body += label(x, 226, note, Anchor::middle, "note");
    panels.push_back(figure);
  };
  panel({DomainKind::projected_disk, false, 0}, "*T* = π *t*");
  panel({DomainKind::equal_area, false, 0}, "*T* = 2π *t* cos *θ*_i");
  panel({DomainKind::half_vector, false, 0}, "cells gather at the mirror image");
  panel({DomainKind::back_vector, false, 0}, "cells gather at the viewer");
  panel({DomainKind::stretched, false, 1.5f}, "*a* = 1.5: cells gather at the rim");
  return side_by_side("Domains",
                      "A square of 16 by 16 even cells and its images on the disk under the five domains, "
                      "for a viewer at 50 degrees.",
                      panels, 3, 10);
}

}  // namespace reflectree::method
