// SPDX-License-Identifier: Apache-2.0
// Step 4: the tree of one slab as it refines: cut at two depths and whole, on its square and on the disk.
#include <algorithm>

#include "coarse_tree.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/draw/square_image.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/square/domain_map.hpp"

namespace reflectree::method {

using namespace draw;

Figure tree_growth_figure(const Example& example) {
  const Domain& domain = example.data.domain;
  constexpr double width = 280, radius = 116;
  const SquarePlace place{38, 56, 2 * radius, domain.half()};
  double highest = 0;
  for (const CoarseLeaf& leaf : cut(example, 64).leaves) highest = std::max(highest, leaf.majorant);
  const Axis range{highest * 2e-3, highest, 0, 1, true};
  const Axis disk_range = log_range(target_image(example.f, example.data.target, example.wo, 220));
  const float albedo = albedo_at(example.data.albedo, example.wo.z);
  std::vector<Figure> panels;
  for (const int depth : {3, 5, 64}) {
    const CoarseTree tree = cut(example, depth);
    const LeafFinder finder(tree.nodes, domain.symmetry);
    const auto bound = [&](Vec2<float> p) { return tree.leaves[finder.find(p).index].bound(p); };
    double volume = 0;
    for (const CoarseLeaf& leaf : tree.leaves) volume += leaf.volume();
    const double x = place.x + radius, y = place.y + place.height() + 40 + radius;
    Figure figure{width, y + radius + 12, "", {}, {}};
    figure.body = label(place.x, 24, std::to_string(tree.leaves.size()) + " leaves", Anchor::start, "head") +
                  label(place.x, 42, number(volume, 2) + " trials per direction", Anchor::start, "note");
    figure.body += square_raster(bound, range, place);
    for (const CoarseLeaf& leaf : tree.leaves) {
      figure.body +=
          cell_rectangle(leaf.cell, place, range.at(leaf.majorant) > 0.62 ? "cell-bright" : "cell-night");
    }
    figure.body += square_axes(place);
    const DiskImage image = disk_image(
        [&](std::span<const Direction> wi, std::span<float> out) {
          for (std::size_t i = 0; i < wi.size(); ++i) {
            const Vec2<float> p = lower(domain, example.wo, fold(domain.symmetry, wi[i]));
            out[i] = float(bound(p)) * albedo / lift(domain, example.wo, p).projected_area;
          }
        },
        420);
    figure.body += disk_raster(image, disk_range, x, y, 2 * radius);
    figure.body += cell_borders(tree.nodes, domain, example.wo, x, y, radius, image, disk_range);
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
