// SPDX-License-Identifier: Apache-2.0
// The sampler of Montes, Urena, Lastra and Garcia 2008 (Generic BRDF sampling, GRAPP) for one wo: a quadtree
// over the square around the unit disk of projected directions. Node i holds I = int f dx dy and M = max f,
// both from a grid of points as in the paper, hence estimates; it is split until n_max I / (size^2 M) >= 1,
// so that rejection in a leaf needs at most n_max trials on average. Plain data.
// Read into it: the size is that of the rectangle in which rejection really takes place, after clipping (by
// the whole square, slivers at the rim would be split without end); the first three levels are split in any
// case. Limits that are the method's own: a maximum between the points is missed and a lobe narrower than
// them lost; where f grows without bound towards the rim no depth is enough (`unmet`).
#pragma once

#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/peers/paper_map.hpp"

namespace reflectree {

// How a leaf is chosen. cdf: the paper's, from the root by the CDF of the four children. warp: by columns,
// then by rows, with a number each, so that a stratified point stays one (Clarberg et al. 2005). alias: at
// once (Walker 1977).
enum class PaperChoice : std::uint8_t { cdf, warp, alias };
// Which tree serves a wo between the tabulated ones. nearest: one. mixed: each neighbour, by its share, and
// the density is their mixture.
enum class PaperBetween : std::uint8_t { nearest, mixed };

struct PaperOptions {
  double n_max = 4;
  int max_depth = 12;  // where the test cannot be met: at an infinite maximum
  int grid = 8;        // points per side of a node's estimates of I and M
  std::size_t max_leaves = 200'000;
  int thetas = 90;  // elevations with a tree of their own
  int phis = 1;     // and azimuths all around; isotropic functions need one
  PaperBetween between = PaperBetween::mixed;
  int max_trials = 4096;  // of one direction; then it is lost
  // Ablations, none in the paper.
  PaperMap map = PaperMap::disk;
  PaperChoice choice = PaperChoice::cdf;
  bool retry_from_root = false;  // leaves by volume; exact whatever the errors of I
  // A node whose volume is a smaller share than this of the whole integral is not split: it can add no more
  // to the mean of the trials. Elsewhere than on the paper's disk T falls to 0 along a line that no square
  // follows, and slivers would be split without end; 0.001 ends that.
  double negligible = 0;
  friend bool operator==(const PaperOptions&, const PaperOptions&) = default;
};

struct PaperNode {
  float x = 0, y = 0, size = 0;  // lower corner, side
  double integral = 0, maximum = 0;
  double volume = 0;     // of a leaf: maximum times the clipped area; else the sum of the children
  int first_child = -1;  // of four; -1: a leaf
  friend bool operator==(const PaperNode&, const PaperNode&) = default;
};

// Of Walker's table: `own` with probability `keep`, else `other`.
struct PaperBucket {
  double keep = 1;
  std::uint32_t own = 0, other = 0;
  friend bool operator==(const PaperBucket&, const PaperBucket&) = default;
};

struct PaperTree {
  Direction wo;                      // for which it was made
  std::vector<PaperNode> nodes;      // the root first
  std::vector<PaperBucket> buckets;  // of the leaves; for PaperChoice::alias alone
  std::size_t unmet = 0;             // leaves in which the n_max test fails
  std::size_t evaluations = 0;       // of f, while it was made
  friend bool operator==(const PaperTree&, const PaperTree&) = default;

  double albedo() const { return nodes[0].integral; }  // I_0
};

PaperTree build_paper_tree(const AnyBrdf& f, Target target, Direction wo, const PaperOptions& options = {});
std::size_t bytes_of(const PaperTree& tree);

// T on the midpoints of a grid over the node's square, row by row; zero off the disk.
// Returns the number of evaluations.
std::size_t paper_grid(const AnyBrdf& f, Target target, Direction wo, PaperMap map, const PaperNode& node,
                       int side, std::vector<double>& values);

// The smallest rectangle around the part of the node's square that lies in the disk: the code of the corners
// inside selects which sides shrink. The whole square where no corner decides.
struct PaperBox {
  double x0, x1, y0, y1;
  double area() const { return x1 > x0 && y1 > y0 ? (x1 - x0) * (y1 - y0) : 0; }
};
PaperBox clip_to_disk(const PaperNode& node);

}  // namespace reflectree
