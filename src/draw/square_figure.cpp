// SPDX-License-Identifier: Apache-2.0
// The tree where it grows: the leaves and their tilted bounds on the square.
#include <algorithm>

#include "disk_frame.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/draw/square_image.hpp"

namespace reflectree::draw {

Figure square_figure(const SamplerData& data, Direction wo) {
  const MajorantTree& tree = data.exact.at(slab_of(data.exact_partition, wo));
  const std::vector<SquareCell> cells = leaf_cells(tree.nodes, data.domain.symmetry);
  const TreeReader reader(tree, data.domain.symmetry);
  double hi = 0, lo = 1e300;
  const auto bound = [&](Vec2<float> p) { return double(tree.volume) * reader.density_at(p); };
  for (const SquareCell& c : cells) {
    for (const float x : {0.01f, 0.99f}) {
      for (const float y : {0.01f, 0.99f}) {
        const double b = bound({linear_mix(x, c.x0, c.x1), linear_mix(y, c.y0, c.y1)});
        hi = std::max(hi, b);
        lo = std::min(lo, b);
      }
    }
  }
  const double total_width = 560;
  SquarePlace place{0, 48, data.domain.half() ? 440.0 : 320.0, data.domain.half()};
  place.x = (total_width - place.width) / 2;
  const Axis range{std::max(lo, hi * 1e-4), std::max(hi, lo * 10), place.x, place.x + place.width, true};
  Figure figure{total_width, place.y + place.height() + 82, "The tree on its square", {}, {}};
  figure.description = "The square of the domain " + std::string(name_of(data.domain.kind)) +
                       " cut into leaves, coloured by their bounds; azimuth to the right, radius upwards.";
  figure.body = label(16, 24, figure.title, Anchor::start, "head") +
                label(total_width - 16, 24, theta_o_text(wo), Anchor::end, "aside");
  figure.body += square_raster(bound, range, place, 400);
  Axis unit = range;
  unit.from = 0;
  unit.to = 1;
  for (const SquareCell& c : cells) {
    const double middle = unit.at(bound({0.5f * (c.x0 + c.x1), 0.5f * (c.y0 + c.y1)}));
    figure.body += cell_rectangle(c, place, middle > 0.62 ? "cell-bright" : "cell-night");
  }
  figure.body += square_axes(place) + colour_bar({range, place.y + place.height() + 36, 8,
                                                  "bound on the normalised target *T* / *â*"});
  return figure;
}

}  // namespace reflectree::draw
