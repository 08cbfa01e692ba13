// SPDX-License-Identifier: Apache-2.0
// Step 8: the density of one-shot mode beside the target, and their ratio, the weight.
#include <cmath>

#include "figures.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/draw/svg.hpp"

namespace reflectree::method {

using namespace draw;

Figure one_shot_figure(const Example& example) {
  const DiskImage target = target_image(example.f, example.data.target, example.wo, 260);
  const DiskImage density = one_shot_image(example.data, example.wo, 260);
  DiskImage weight = target;
  for (std::size_t i = 0; i < weight.value.size(); ++i) weight.value[i] /= density.value[i];
  const DensityTree& tree = example.data.one_shot.at(slab_of(example.data.one_shot_partition, example.wo));
  const Axis range = log_range(target), ratio{0.8, 1.25, 0, 1, true};
  const double width = 268, radius = 118, x = width / 2, y = 164;
  std::vector<Figure> panels;
  const auto panel = [&](const std::string& title, const DiskImage& image, Axis axis, const Palette& colours,
                         const std::string& unit, const std::string& borders) {
    Figure figure{width, 344, title, {}, {}};
    figure.body =
        label(x, 26, title, Anchor::middle, "head") + disk_raster(image, axis, x, y, 2 * radius, "", colours);
    figure.body += borders + circle(x, y, radius, "rim");
    axis.from = x - radius;
    axis.to = x + radius;
    figure.body += colour_bar({axis, 300, 8, unit, &colours});
    panels.push_back(figure);
  };
  panel("target", target, range, palette(), "*t* / sr⁻¹", "");
  panel(std::to_string(tree.mass.size()) + " product-linear leaves", density, range, palette(),
        "*a* × density / sr⁻¹",
        cell_borders(tree.nodes, example.data.domain, example.wo, x, y, radius, density, range));
  panel("weight", weight, ratio, diverging_palette(), "weight / albedo", "");
  return side_by_side(
      "One-shot mode",
      "The target of the material seen at 50 degrees, the piecewise product-linear density of "
      "the one-shot tree, and "
      "their ratio, which is near one everywhere.",
      panels, 3, 8);
}

}  // namespace reflectree::method
