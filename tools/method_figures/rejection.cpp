// SPDX-License-Identifier: Apache-2.0
// Steps 6 and 7: trials under the bounds, accepted and rejected; and why a rejection starts
// again from the leaf choice.
#include <algorithm>
#include <cmath>

#include "coarse_tree.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/draw/plot.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/square/domain_map.hpp"

namespace reflectree::method {

using namespace draw;

namespace {

void cross(PathData& data, double x, double y, double r) {
  data.move_to(x - r, y - r);
  data.line_to(x + r, y + r);
  data.move_to(x - r, y + r);
  data.line_to(x + r, y - r);
}

constexpr int coarse_depth = 8;

}  // namespace

Figure rejection_figure(const Example& example) {
  const Domain& domain = example.data.domain;
  const CoarseTree tree = cut(example, coarse_depth);
  const LeafFinder finder(tree.nodes, domain.symmetry);
  Figure figure{840, 372, "Accepted and rejected", {}, {}};
  figure.body = label(16, 26, "A cut through the square: trials under the bounds", Anchor::start, "head");
  figure.description =
      "Left: points uniform under the bounds of leaves; those under the target are accepted. Right: "
      "the "
      "same trials over the disk, dots accepted, crosses rejected.";

  // Left: the cut from the pole to the rim, a little aside of the plane of incidence.
  constexpr float cut_x = -0.9f;
  constexpr int steps = 600;
  std::vector<double> x, target, bound;
  double highest = 0;
  for (int i = 0; i <= steps; ++i) {
    const Vec2<float> p{cut_x, (float(i) + 0.5f) / (steps + 1)};
    x.push_back(double(p.y));
    target.push_back(normalised_target(example, p));
    bound.push_back(tree.leaves[finder.find(p).index].bound(p));
    highest = std::max(highest, bound.back());
  }
  Frame f;
  f.x = {0, 1, 50, 440};
  f.y = {0, highest * 1.08, 318, 62};
  f.x_ticks = ticks(f.x, 5);
  f.y_ticks = ticks(f.y, 5);
  f.x_title = "*y* on the square: from the pole to the rim";
  f.y_title = "*T* / *a*, and the bounds of the leaves";
  figure.body += frame(f);
  Pcg32 random(6);
  PathData accepted, rejected;
  for (int tried = 0; tried < 420;) {
    const double u = to_unit_double(random()), z = to_unit_double(random()) * highest;
    const auto i = std::size_t(u * steps);
    if (z > bound[i]) continue;
    ++tried;
    if (z < target[i]) {
      accepted.dot(f.x.at(x[i]), f.y.at(z));
    } else {
      cross(rejected, f.x.at(x[i]), f.y.at(z), 2.1);
    }
  }
  figure.body += path(accepted, "accepted") + path(rejected, "rejected");
  figure.body += curve(f, x, bound, "stairs") + curve(f, x, target, "curve");

  // Right: trials of the whole coarse tree over the disk.
  const double cx = 656, cy = 196, radius = 148;
  double total = 0;
  for (const CoarseLeaf& leaf : tree.leaves) total += leaf.volume();
  figure.body += label(484, 26, "The same over the disk", Anchor::start, "head");
  const DiskImage image = target_image(example.f, example.data.target, example.wo, 240);
  figure.body += disk_raster(image, log_range(image), cx, cy, 2 * radius, "pale");
  PathData kept, dropped;
  for (int tried = 0; tried < 900; ++tried) {
    double v = to_unit_double(random()) * total;
    std::size_t i = 0;
    while (i + 1 < tree.leaves.size() && v >= tree.leaves[i].volume()) v -= tree.leaves[i++].volume();
    const CoarseLeaf& leaf = tree.leaves[i];
    const double highest_shape = (1 + std::abs(leaf.slope_x)) * (1 + std::abs(leaf.slope_y));
    Vec2<float> p;
    do {  // in proportion to the bound across the leaf
      p = {linear_mix(to_unit_float(random()), leaf.cell.x0, leaf.cell.x1),
           linear_mix(to_unit_float(random()), leaf.cell.y0, leaf.cell.y1)};
    } while (to_unit_double(random()) * leaf.majorant * highest_shape >= leaf.bound(p));
    const DomainPoint point = lift(domain, example.wo, p);
    const double side = domain.half() && (random() & 1U) ? -1 : 1;
    const double px = cx + radius * double(point.geometry.wi.x),
                 py = cy - side * radius * double(point.geometry.wi.y);
    if (to_unit_double(random()) * leaf.bound(p) < normalised_target(example, p)) {
      kept.dot(px, py);
    } else {
      cross(dropped, px, py, 2.1);
    }
  }
  figure.body += path(dropped, "rejected") + path(kept, "accepted") + circle(cx, cy, radius, "rim");
  PathData one, two;
  one.dot(62, 362);
  cross(two, 162, 362, 2.6);
  figure.body += path(one, "accepted") + label(72, 366, "accepted", Anchor::start, "note") +
                 path(two, "rejected") + label(172, 366, "rejected: start again", Anchor::start, "note");
  return figure;
}

Figure restart_figure(const Example& example) {
  const CoarseTree tree = cut(example, 7);
  double volume = 0, integral = 0, worst = 0;
  for (const CoarseLeaf& leaf : tree.leaves) volume += leaf.volume(), integral += leaf.integral;
  Figure figure{840, 300, "Why a rejection starts again", {}, {}};
  figure.body = label(16, 26, "Why a rejection starts again from the leaf choice", Anchor::start, "head");
  Frame f;
  const double n = double(tree.leaves.size());
  f.x = {0, n, 50, 824};
  for (const CoarseLeaf& leaf : tree.leaves) {
    worst = std::max({worst, leaf.volume() / volume, leaf.integral / integral});
  }
  f.y = {0, worst * 1.1, 232, 64};
  f.y_ticks = ticks(f.y, 4);
  f.x_title = "leaves of a coarse tree";
  f.y_title = "probability of the leaf";
  figure.body += frame(f);
  double largest_error = 0;
  for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
    const CoarseLeaf& leaf = tree.leaves[i];
    const double left = f.x.at(double(i) + 0.12), middle = f.x.at(double(i) + 0.5),
                 right = f.x.at(double(i) + 0.88);
    const double chosen = f.y.at(leaf.volume() / volume), truth = f.y.at(leaf.integral / integral);
    figure.body += rectangle(left, chosen, middle - left, f.y.from - chosen, "bar");
    figure.body += rectangle(middle, truth, right - middle, f.y.from - truth, "fill-strong");
    largest_error = std::max(largest_error, std::abs(leaf.volume() / volume - leaf.integral / integral));
  }
  figure.body += rectangle(50, 276, 14, 9, "bar") +
                 label(70, 285, "∝ *V*: what retrying inside the leaf would return", Anchor::start, "note") +
                 rectangle(370, 276, 14, 9, "fill-strong") +
                 label(390, 285, "∝ ∫*T*: the truth, and what starting again returns", Anchor::start, "note");
  figure.description =
      "Two bars per leaf: its share of the volume under the bounds and its share of the target. They differ "
      "by up to " +
      number(100 * largest_error, 1) + " percentage points; retrying inside the leaf would return the first.";
  return figure;
}

}  // namespace reflectree::method
