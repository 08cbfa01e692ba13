// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/paper_tree.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/peers/paper_choice.hpp"

namespace reflectree {

namespace {

bool inside(double x, double y) { return x * x + y * y < 1; }

}  // namespace

std::size_t paper_grid(const AnyBrdf& f, Target target, Direction wo, PaperMap map, const PaperNode& node,
                       int side, std::vector<double>& values) {
  values.assign(std::size_t(side * side), 0);
  std::vector<Direction> wi;
  std::vector<std::size_t> place;
  const double step = double(node.size) / side;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const auto w =
          direction_at(map, wo, double(node.x) + (i + 0.5) * step, double(node.y) + (j + 0.5) * step);
      if (w) wi.push_back(*w), place.push_back(std::size_t(j * side + i));
    }
  }
  const std::vector<Direction> wos(wi.size(), wo);
  const auto channels = std::size_t(f.channels());
  std::vector<float> raw(wi.size() * channels);
  f.eval(wos, wi, raw);
  for (std::size_t k = 0; k < wi.size(); ++k) {
    values[place[k]] = double(target(&raw[k * channels], int(channels))) * double(wi[k].z) *
                       solid_angle_per_area(map, wo, wi[k]);
  }
  return wi.size();
}

PaperTree build_paper_tree(const AnyBrdf& f, Target target, Direction wo, const PaperOptions& o) {
  PaperTree tree;
  tree.wo = wo;
  std::vector<int> depth{0};
  std::vector<double> values;
  const auto filled = [&](PaperNode node) {
    tree.evaluations += paper_grid(f, target, wo, o.map, node, o.grid, values);
    const double cell = double(node.size) * double(node.size) / double(values.size());
    for (const double t : values) node.integral += t * cell, node.maximum = std::max(node.maximum, t);
    node.volume = clip_to_disk(node).area() * node.maximum;
    return node;
  };
  tree.nodes.push_back(filled({-1, -1, 2}));
  double total = tree.nodes[0].integral;  // as well as the leaves know it
  // Breadth first: where max_leaves ends the work, it ends it evenly.
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const PaperNode node = tree.nodes[i];
    // The square around the disk is split three times in any case: a coarser grid misses lobes altogether.
    if (depth[i] >= 3) {
      if (o.n_max * node.integral >= node.volume) continue;
      const bool negligible = node.volume < o.negligible * total;
      if (negligible || depth[i] >= o.max_depth || tree.nodes.size() + 4 > o.max_leaves / 3 * 4) {
        ++tree.unmet;
        continue;
      }
    }
    tree.nodes[i].first_child = int(tree.nodes.size());
    const float half = node.size / 2;
    total -= node.integral;
    for (int c = 0; c < 4; ++c) {
      tree.nodes.push_back(filled({node.x + (c & 1 ? half : 0), node.y + (c & 2 ? half : 0), half}));
      total += tree.nodes.back().integral;
      depth.push_back(depth[i] + 1);
    }
  }
  // An inner node is the sum of its children.
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    PaperNode& node = tree.nodes[i];
    if (node.first_child < 0) continue;
    node.integral = node.volume = 0;
    for (int c = 0; c < 4; ++c) {
      const PaperNode& child = tree.nodes[std::size_t(node.first_child + c)];
      node.integral += child.integral, node.volume += child.volume;
    }
  }
  if (o.choice == PaperChoice::alias) tree.buckets = make_paper_buckets(tree, o.retry_from_root);
  return tree;
}

std::size_t bytes_of(const PaperTree& tree) {
  return sizeof(tree) + tree.nodes.size() * sizeof(PaperNode) + tree.buckets.size() * sizeof(PaperBucket);
}

PaperBox clip_to_disk(const PaperNode& n) {
  PaperBox b{double(n.x), double(n.x) + double(n.size), double(n.y), double(n.y) + double(n.size)};
  const unsigned code = unsigned(inside(b.x0, b.y0)) | unsigned(inside(b.x1, b.y0)) << 1U |
                        unsigned(inside(b.x0, b.y1)) << 2U | unsigned(inside(b.x1, b.y1)) << 3U;
  const auto reach = [](double c) { return std::sqrt(std::max(0.0, 1 - c * c)); };
  // A side is pulled in to where the circle crosses the two sides beside it; only squares of one quadrant,
  // which is all squares but the root, have a farthest corner.
  const double near_x = std::min(std::abs(b.x0), std::abs(b.x1)),
               near_y = std::min(std::abs(b.y0), std::abs(b.y1));
  if (code == 15 || b.x0 * b.x1 < 0 || b.y0 * b.y1 < 0) return b;
  (b.x0 >= 0 ? b.x1 : b.x0) = b.x0 >= 0 ? std::min(b.x1, reach(near_y)) : std::max(b.x0, -reach(near_y));
  (b.y0 >= 0 ? b.y1 : b.y0) = b.y0 >= 0 ? std::min(b.y1, reach(near_x)) : std::max(b.y0, -reach(near_x));
  return b;
}

}  // namespace reflectree
