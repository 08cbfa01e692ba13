// SPDX-License-Identifier: Apache-2.0
// The partition of theta_o: a bar for each slab, as wide as the slab, as high as its tree has leaves.
#include <algorithm>

#include "reflectree/draw/material_figures.hpp"

namespace reflectree::draw {

namespace {

template <class T>
std::size_t leaves_of(const std::vector<T>& trees) {
  std::size_t sum = 0;
  for (const T& tree : trees) sum += tree.mass.size();
  return sum;
}

std::string summary(const char* mode, std::size_t slabs, std::size_t leaves) {
  return std::string(mode) + ": " + std::to_string(slabs) + (slabs == 1 ? " slab, " : " slabs, ") +
         pretty(double(leaves), 9) + (leaves == 1 ? " leaf" : " leaves");
}

template <class T>
std::string panel(const Partition& partition, const std::vector<T>& trees, double top,
                  const std::string& title, const char* fill, const char* stroke, bool lowest) {
  constexpr double deg = pi_v<double> / 180;
  std::size_t most = 1;
  for (const T& tree : trees) most = std::max(most, tree.mass.size());
  Frame f;
  f.x = {0, 90, 54, 544};
  f.y = {0, 1.08 * double(most), top + 96, top};
  f.x_ticks = ticks_every(f.x, 15, "°");
  f.y_ticks = ticks(f.y, 3);
  f.y_title = title;
  if (lowest) f.x_title = "*θ*_o of the viewer";
  std::string out = frame(f);
  const std::vector<SlabBox> boxes = slab_boxes(partition);
  PathData outline;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const double x0 = f.x.at(double(boxes[i].lo[0]) / deg), x1 = f.x.at(double(boxes[i].hi[0]) / deg);
    const double y = f.y.at(double(trees[i].mass.size()));
    out += rectangle(x0, y, x1 - x0, f.y.from - y, fill);
    outline.move_to(x0, f.y.from);
    outline.line_to(x0, y);
    outline.line_to(x1, y);
    outline.line_to(x1, f.y.from);
  }
  return out + path(outline, stroke);
}

}  // namespace

Figure slabs_figure(const SamplerData& data) {
  const std::string exact = summary("exact", data.exact.size(), leaves_of(data.exact));
  const std::string one_shot = summary("one-shot", data.one_shot.size(), leaves_of(data.one_shot));
  Figure figure{560, 336, "Slabs of theta_o and their leaves", {}, {}};
  figure.description =
      "Bars over the viewer's elevation, one per slab, as high as the slab's tree has leaves; " + exact +
      "; " + one_shot + ".";
  figure.body = label(16, 24, "Slabs of *θ*_o and their leaves", Anchor::start, "head");
  figure.body += panel(data.exact_partition, data.exact, 56, exact, "fill-1", "curve-thin", false);
  figure.body += panel(data.one_shot_partition, data.one_shot, 200, one_shot, "fill-2", "bar-line", true);
  return figure;
}

}  // namespace reflectree::draw
