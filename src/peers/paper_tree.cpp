// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/paper_tree.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/math/square_maps.hpp"

namespace reflectree {

namespace {

struct Estimate {
  double integral = 0, maximum = 0;
};

// I and M from the midpoints of a grid on the node's square; points outside of the disk count as zeros.
Estimate estimate(const AnyBrdf& f, Target target, Direction wo, const PaperOptions& o,
                  const PaperNode& node) {
  std::vector<Direction> wi;
  const double step = double(node.size) / o.grid;
  for (int j = 0; j < o.grid; ++j) {
    for (int i = 0; i < o.grid; ++i) {
      const double x = double(node.x) + (i + 0.5) * step, y = double(node.y) + (j + 0.5) * step;
      if (x * x + y * y >= 1) continue;
      const Vec2<float> p{float(x), float(y)};
      const Direction w =
          o.area_preserving ? disk_to_hemisphere_equal_area(p) : disk_to_hemisphere_projected(p);
      if (w.z > 0) wi.push_back(w);
    }
  }
  const std::vector<Direction> wos(wi.size(), wo);
  const auto channels = std::size_t(f.channels());
  std::vector<float> values(wi.size() * channels);
  f.eval(wos, wi, values);
  Estimate e;
  for (std::size_t k = 0; k < wi.size(); ++k) {
    const double t =
        double(target(&values[k * channels], int(channels))) * (o.area_preserving ? 2 * double(wi[k].z) : 1);
    e.integral += t * step * step;
    e.maximum = std::max(e.maximum, t);
  }
  return e;
}

// What a node weighs in the choice of a child: I, or, retrying from the root, the volume under the bounds.
double mass_of(const PaperNode& node, bool by_volume) { return by_volume ? node.volume : node.integral; }

bool inside(double x, double y) { return x * x + y * y < 1; }

}  // namespace

PaperTree build_paper_tree(const AnyBrdf& f, Target target, Direction wo, const PaperOptions& o) {
  PaperTree tree;
  std::vector<int> depth{0};
  const auto filled = [&](PaperNode node) {
    const Estimate e = estimate(f, target, wo, o, node);
    node.integral = e.integral, node.maximum = e.maximum;
    node.volume = clip_to_disk(node).area() * e.maximum;
    return node;
  };
  tree.nodes.push_back(filled({-1, -1, 2}));
  // Breadth first: where max_leaves ends the work, it ends it evenly.
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const PaperNode node = tree.nodes[i];
    // The square around the disk is split three times in any case: a coarser grid misses lobes altogether.
    if (depth[i] >= 3 && o.n_max * node.integral >= node.volume) continue;
    if (depth[i] >= o.max_depth || tree.nodes.size() + 4 > o.max_leaves / 3 * 4) {
      ++tree.unmet;
      continue;
    }
    tree.nodes[i].first_child = int(tree.nodes.size());
    const float half = node.size / 2;
    for (int c = 0; c < 4; ++c) {
      const PaperNode child{node.x + (c & 1 ? half : 0), node.y + (c & 2 ? half : 0), half};
      tree.nodes.push_back(filled(child));
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
  return tree;
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

std::size_t choose_paper_leaf(const PaperTree& tree, double u, bool by_volume) {
  std::size_t i = 0;
  while (tree.nodes[i].first_child >= 0) {
    const auto first = std::size_t(tree.nodes[i].first_child);
    double rest = u * mass_of(tree.nodes[i], by_volume), chosen_mass = 0;
    std::size_t chosen = first;
    for (std::size_t c = first; c < first + 4; ++c) {
      const double mass = mass_of(tree.nodes[c], by_volume);
      if (!(mass > 0)) continue;
      chosen = c, chosen_mass = mass;
      if (rest < mass) break;
      if (c < first + 3) rest -= mass;
    }
    u = chosen_mass > 0 ? std::clamp(rest / chosen_mass, 0.0, 0x1.fffffffffffffp-1) : 0;
    i = chosen;
  }
  return i;
}

void divide_paper_count(const PaperTree& tree, std::size_t n, UniformBits& u, bool by_volume,
                        std::span<std::size_t> counts) {
  counts[0] = n;  // children come after their parents
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    if (tree.nodes[i].first_child < 0) continue;
    const auto first = std::size_t(tree.nodes[i].first_child);
    const double total = mass_of(tree.nodes[i], by_volume), offset = to_unit_double(u());
    double cumulative = 0;
    std::size_t before = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      cumulative += mass_of(tree.nodes[first + c], by_volume);
      const double edge = total > 0 ? cumulative / total * double(counts[i]) + offset : 0;
      const std::size_t upto = c == 3 ? counts[i] : std::min(std::size_t(edge), counts[i]);
      counts[first + c] = std::max(upto, before) - before;
      before = std::max(before, upto);
    }
    counts[i] = 0;
  }
}

}  // namespace reflectree
