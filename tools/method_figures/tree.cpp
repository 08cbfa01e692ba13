// SPDX-License-Identifier: Apache-2.0
// Step 4: the tree of one slab as it refines: cut at four depths, on its square and on the disk.
#include <algorithm>

#include "coarse_tree.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/sampler/albedo.hpp"
#include "reflectree/sampler/domain_map.hpp"

namespace reflectree::method {

using namespace draw;

Figure tree_growth_figure(const Example& example) {
  const Domain& domain = example.data.domain;
  const double width = 268, side = 244, left = 12, top = 56, height = domain.half ? side / 2 : side,
               radius = 118;
  const CoarseTree finest = cut(example, 64);
  double lowest = 1e300, highest = 0;
  for (const CoarseLeaf& leaf : finest.leaves) {
    if (leaf.majorant > 0) lowest = std::min(lowest, leaf.majorant);
    highest = std::max(highest, leaf.majorant);
  }
  const Axis range{std::max(lowest, highest * 1e-4), highest, 0, 1, true};
  const Axis disk_range = log_range(target_image(example.f, example.data.target, example.wo, 220));
  std::vector<Figure> panels;
  for (const int depth : {3, 5, 64}) {
    const CoarseTree tree = cut(example, depth);
    double volume = 0;
    for (const CoarseLeaf& leaf : tree.leaves) volume += leaf.volume();
    Figure figure{width, top + height + 40 + 2 * radius + 12, "", {}, {}};
    const std::string title = std::to_string(tree.leaves.size()) + " leaves";
    figure.body = label(left, 24, title, Anchor::start, "head") +
                  label(left, 42, number(volume, 2) + " trials a direction", Anchor::start, "note");
    for (const CoarseLeaf& leaf : tree.leaves) {
      figure.body += cell_rectangle(leaf.cell, domain, left, top, side,
                                    range.at(leaf.majorant) > 0.62 ? "cell-bright" : "cell-night",
                                    rgb_text(range.at(leaf.majorant)));
    }
    const double x = left + side / 2, y = top + height + 24 + radius;
    const LeafFinder finder(tree.nodes, domain);
    const float albedo = albedo_at(example.data.albedo, example.wo.z);
    const DiskImage bound = disk_image(
        [&](std::span<const Direction> wi, std::span<float> out) {
          for (std::size_t i = 0; i < wi.size(); ++i) {
            const Direction folded{wi[i].x, domain.half ? abs(wi[i].y) : wi[i].y, wi[i].z};
            const Vec2<float> p = lower(domain, example.wo, folded);
            const float area = lift(domain, example.wo, p).projected_area;
            out[i] = area > 0 ? float(tree.leaves[finder.find(p).index].bound(p)) * albedo / area : 0.f;
          }
        },
        220);
    figure.body += disk_raster(bound, disk_range, x, y, 2 * radius);
    figure.body += cell_borders(tree.nodes, domain, example.wo, x, y, radius, bound, disk_range);
    figure.body += circle(x, y, radius, "rim");
    panels.push_back(figure);
  }
  return side_by_side(
      "The tree of one slab",
      "The square of the domain " + std::string(name_of(domain.kind)) +
          " cut into more and more cells, and the same cells bent over the disk: the expected "
          "number of trials falls to that of the whole tree.",
      panels, 3, 8);
}

}  // namespace reflectree::method
