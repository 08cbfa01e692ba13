// SPDX-License-Identifier: Apache-2.0
// The sampler of Montes, Urena, Lastra and Garcia 2008 (Generic BRDF sampling, GRAPP) for one wo: a quadtree
// over the square around the unit disk of projected directions. Node i holds I = int f dx dy and M = max f,
// both from a grid of points as in the paper, hence estimates; it is split until n_max I / (size^2 M) >= 1,
// so that rejection in a leaf needs at most n_max trials on average. The size is that of the rectangle in
// which rejection really takes place, after clipping: by the whole square, slivers at the rim would be split
// without end. Plain data. Limits that are the method's own: a maximum between the points is missed and a
// lobe narrower than them lost; where f grows without bound towards the rim no depth is enough (`unmet`).
#pragma once

#include <span>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/math/uniform_bits.hpp"

namespace reflectree {

struct PaperOptions {
  double n_max = 4;
  int max_depth = 12;  // where the test cannot be met: at an infinite maximum
  int grid = 8;        // points a side of a node's estimates of I and M
  std::size_t max_leaves = 200'000;
  int thetas = 90;        // elevations with a tree of their own
  int max_trials = 4096;  // of one direction; then it is lost
  // Ablations, each off in the paper.
  bool area_preserving = false;  // Lambert's equal-area disk; f cos_i is bounded where f is not
  bool retry_from_root = false;  // leaves by volume; exact whatever the errors of I
  friend bool operator==(const PaperOptions&, const PaperOptions&) = default;
};

struct PaperNode {
  float x = 0, y = 0, size = 0;  // lower corner, side
  double integral = 0, maximum = 0;
  double volume = 0;     // of a leaf: maximum times the clipped area; else the sum of the children
  int first_child = -1;  // of four; -1: a leaf
  friend bool operator==(const PaperNode&, const PaperNode&) = default;
};

struct PaperTree {
  std::vector<PaperNode> nodes;  // the root first
  std::size_t unmet = 0;         // leaves in which the n_max test still fails
  friend bool operator==(const PaperTree&, const PaperTree&) = default;
};

PaperTree build_paper_tree(const AnyBrdf& f, Target target, Direction wo, const PaperOptions& options = {});

// The smallest rectangle around the part of the node's square that lies in the disk: the code of the corners
// inside selects which sides shrink. The whole square where no corner decides.
struct PaperBox {
  double x0, x1, y0, y1;
  double area() const { return x1 > x0 && y1 > y0 ? (x1 - x0) * (y1 - y0) : 0; }
};
PaperBox clip_to_disk(const PaperNode& node);

// A leaf by the CDF of the children, from the root.
std::size_t choose_paper_leaf(const PaperTree& tree, double u, bool by_volume);
// counts[node] for every leaf: n divided among the children by their CDF, in one traversal. What rounding
// leaves over is placed by one random offset a node, so that each count has the right mean.
void divide_paper_count(const PaperTree& tree, std::size_t n, UniformBits& u, bool by_volume,
                        std::span<std::size_t> counts);

}  // namespace reflectree
