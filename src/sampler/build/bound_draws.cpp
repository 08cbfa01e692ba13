// SPDX-License-Identifier: Apache-2.0
#include "bound_draws.hpp"

#include <algorithm>

#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree::detail {

Urn urn_of(const Slab& slab) {
  Urn urn;
  for (const std::uint32_t i : leaves_in_order(slab)) {
    urn.leaves.push_back(&slab.nodes[i].leaf);
    urn.upper.push_back(urn.volume() + double(slab.nodes[i].leaf.cost));
  }
  return urn;
}

BoundDraw draw(const Urn& urn, const Domain& domain, Pcg32& u) {
  const double at = urn.volume() * to_unit_double(u());
  const auto found = std::min(std::upper_bound(urn.upper.begin(), urn.upper.end(), at), urn.upper.end() - 1);
  const Leaf& leaf = *urn.leaves[std::size_t(found - urn.upper.begin())];
  const Box box = box_of(leaf.cell, domain);
  const float x = box.x0 + box.width * sample_linear(leaf.slope_x, to_unit_float(u()));
  const float y = box.y0 + box.height * sample_linear(leaf.slope_y, to_unit_float(u()));
  return {{x, y}, leaf.height * shape(leaf, box, {x, y})};
}

}  // namespace reflectree::detail
