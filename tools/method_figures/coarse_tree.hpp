// SPDX-License-Identifier: Apache-2.0
// A built tree cut off at a depth, so that a picture can show all of it.
#pragma once

#include <vector>

#include "figures.hpp"
#include "reflectree/draw/svg.hpp"

namespace reflectree::method {

struct CoarseLeaf {
  SquareCell cell;
  double share = 0;                 // of the square
  double majorant = 0;              // of the leaf; of merged leaves, the largest of their bounds
  double slope_x = 0, slope_y = 0;  // of the leaf's shape; merged leaves are flat
  double mass = 0;                  // the volume of the leaf or of all leaves merged into it
  double integral = 0;              // of T / albedo over the leaf, for one wo
  double volume() const { return share * majorant; }
  double bound(Vec2<float> p) const {
    const double s = double(2 * (p.x - cell.x0) / (cell.x1 - cell.x0) - 1);
    const double t = double(2 * (p.y - cell.y0) / (cell.y1 - cell.y0) - 1);
    return majorant * (1 + slope_x * s) * (1 + slope_y * t);
  }
};

struct CoarseTree {
  std::vector<TreeSplit> nodes;    // preorder
  std::vector<CoarseLeaf> leaves;  // in preorder
};

// The exact tree of the slab of wo.
CoarseTree cut(const Example& example, int depth);

// T / albedo at a point of the square.
double normalised_target(const Example& example, Vec2<float> p);

}  // namespace reflectree::method
