// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "reflectree/draw/material_figures.hpp"

namespace reflectree::draw {

Figure slabs_figure(const SamplerData& data) {
  constexpr double deg = pi_v<double> / 180;
  const double width = 560;
  Figure figure{width, 300, "Slabs of *θ*_o and their leaves", {}, {}};
  std::size_t most = 1;
  for (const MajorantTree& t : data.exact) most = std::max(most, t.mass.size());
  for (const DensityTree& t : data.one_shot) most = std::max(most, t.mass.size());
  Frame f;
  f.x = {0, 90, 54, width - 16};
  f.y = {1, std::max(10.0, 1.5 * double(most)), 232, 52, true};
  f.x_ticks = ticks_every(f.x, 15, "°");
  f.y_ticks = ticks(f.y, 4);
  f.x_title = "*θ*_o of the viewer";
  figure.body = label(16, 24, figure.title, Anchor::start, "head");
  figure.title = "Slabs of theta_o and their leaves";
  figure.body += frame(f);
  const auto steps = [&](const Partition& partition, const auto& trees, const char* fill,
                         const char* stroke) {
    const std::vector<SlabBox> boxes = slab_boxes(partition);
    PathData outline;
    for (std::size_t i = 0; i < trees.size(); ++i) {
      const double x0 = f.x.at(double(boxes[i].lo[0]) / deg), x1 = f.x.at(double(boxes[i].hi[0]) / deg);
      const double y = f.y.at(double(trees[i].mass.size()));
      figure.body += rectangle(x0, y, x1 - x0, f.y.from - y, fill);
      outline.move_to(x0, f.y.from);
      outline.line_to(x0, y);
      outline.line_to(x1, y);
      outline.line_to(x1, f.y.from);
    }
    figure.body += path(outline, stroke);
  };
  steps(data.exact_partition, data.exact, "fill-1", "curve-thin");
  steps(data.one_shot_partition, data.one_shot, "fill-2", "bar-line");
  figure.body +=
      rectangle(54, 276, 14, 9, "fill-1") +
      label(73, 285, "exact: " + std::to_string(data.exact.size()) + " slabs", Anchor::start, "note") +
      rectangle(194, 276, 14, 9, "fill-2") +
      label(213, 285, "one-shot: " + std::to_string(data.one_shot.size()) + " slabs", Anchor::start, "note") +
      label(54, 44, "leaves of the slab's tree", Anchor::start, "note");
  figure.description =
      std::to_string(data.exact.size()) + " exact and " + std::to_string(data.one_shot.size()) +
      " one-shot slabs over the viewer's elevation; bars give the leaves of each slab's tree.";
  return figure;
}

}  // namespace reflectree::draw
