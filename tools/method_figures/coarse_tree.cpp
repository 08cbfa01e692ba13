// SPDX-License-Identifier: Apache-2.0
#include "coarse_tree.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/draw/disk_image.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/square/domain_map.hpp"

namespace reflectree::method {

namespace {

// Follows the fine tree in preorder; below `depth` leaves are merged into the last coarse one.
class Cutter {
 public:
  Cutter(const MajorantTree& fine, const Domain& domain, CoarseTree& coarse)
      : fine_(fine), coarse_(coarse), domain_(domain), cells_(leaf_cells(fine.nodes, domain.symmetry)) {
    total_ = total_mass(fine);
  }

  void visit(SquareCell box, int depth) {
    const TreeSplit split = fine_.nodes[node_++];
    const bool open = depth > 0 && split != TreeSplit::leaf;
    if (depth >= 0) coarse_.nodes.push_back(open ? split : TreeSplit::leaf);
    if (depth >= 0 && !open) coarse_.leaves.push_back({box, share_of(box, domain_.symmetry), 0, 0, 0, 0, 0});
    if (split == TreeSplit::leaf) {
      const double mean =
          double(fine_.volume) * fine_.mass[leaf_] / total_ / share_of(cells_[leaf_], domain_.symmetry);
      const double gx = fine_.slope_x[leaf_] / 128.0, gy = fine_.slope_y[leaf_] / 128.0;
      CoarseLeaf& leaf = coarse_.leaves.back();
      leaf.mass += double(fine_.volume) * fine_.mass[leaf_] / total_;
      if (depth >= 0) {
        leaf.majorant = mean;
        leaf.slope_x = gx;
        leaf.slope_y = gy;
      } else {
        leaf.majorant = std::max(leaf.majorant, mean * (1 + std::abs(gx)) * (1 + std::abs(gy)));
      }
      ++leaf_;
      return;
    }
    const SquareHalves halves = halves_of(box, split);
    const int below = open ? depth - 1 : -1;
    visit(halves.lower, below);
    visit(halves.upper, below);
  }

 private:
  const MajorantTree& fine_;
  CoarseTree& coarse_;
  Domain domain_;
  std::vector<SquareCell> cells_;
  double total_ = 0;
  std::size_t node_ = 0, leaf_ = 0;
};

}  // namespace

double normalised_target(const Example& example, Vec2<float> p) {
  const DomainPoint point = lift(example.data.domain, example.wo, p);
  const Spectrum value = example.f(point.geometry);
  return double(example.data.target(value) * point.projected_area /
                albedo_at(example.data.albedo, example.wo.z));
}

CoarseTree cut(const Example& example, int depth) {
  const Domain& domain = example.data.domain;
  CoarseTree coarse;
  Cutter(example.data.exact.at(draw::slab_of(example.data.exact_partition, example.wo)), domain, coarse)
      .visit(root_cell(domain.symmetry), depth);
  for (CoarseLeaf& leaf : coarse.leaves) {
    constexpr int n = 48;
    for (int k = 0; k < n * n; ++k) {
      const float u = (float(k % n) + 0.5f) / n, v = (float(k) / n + 0.5f / n) / n;
      const SquareCell& c = leaf.cell;
      leaf.integral += normalised_target(example, {linear_mix(u, c.x0, c.x1), linear_mix(v, c.y0, c.y1)}) *
                       leaf.share / (n * n);
    }
  }
  return coarse;
}

}  // namespace reflectree::method
