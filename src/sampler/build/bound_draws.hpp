// SPDX-License-Identifier: Apache-2.0
// Points drawn from the bounds of a tree, as exact mode draws them, and the bound there.
#pragma once

#include "reflectree/math/random.hpp"
#include "slab.hpp"

namespace reflectree::detail {

// A tree's leaves, to be drawn from in proportion to the volumes under their bounds.
struct Urn {
  std::vector<const Leaf*> leaves;
  std::vector<double> upper;
  double volume() const { return upper.empty() ? 0 : upper.back(); }
};
// Refers to the leaves of `slab`.
Urn urn_of(const Slab& slab);

struct BoundDraw {
  Vec2<float> p;
  float bound;  // of T / albedo
};
BoundDraw draw(const Urn& urn, const Domain& domain, Pcg32& u);

}  // namespace reflectree::detail
