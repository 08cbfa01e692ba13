// SPDX-License-Identifier: Apache-2.0
// Which slab of a partition over several known coordinates holds a viewer. Halved slabs share their borders:
// a coordinate has few different ones, and a grid over all of them has a slab in every cell. Where it would
// be too large, borders that come deep in the tree are left out, and a cell has a node to go on from.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "reflectree/math/scalar.hpp"
#include "reflectree/sampler/known/cosine_lookup.hpp"
#include "reflectree/sampler/known/parameter.hpp"
#include "reflectree/sampler/known/partition.hpp"
#include "reflectree/sampler/known/viewer_frame.hpp"

namespace reflectree {

class SlabTree {
 public:
  SlabTree() = default;
  // Coordinate 0 is theta_o; phi_o, radians, where it is known, coordinate 1; parameters follow.
  explicit SlabTree(const Partition& partition, const std::vector<KnownParameter>& parameters = {});
  bool empty() const { return grid_.empty(); }
  // others: all coordinates but theta_o, by their place in the partition from 1 on; phi_o by its azimuth_key,
  // parameters as they were given, without a logarithm. Borders belong to the upper slab.
  std::size_t operator()(float cos_theta_o, const float* others) const {
    std::size_t cell = cosines_(cos_theta_o);
    for (std::size_t a = 0; a < others_; ++a) cell += axes_[a](others[a]) * axes_[a].stride;
    std::uint32_t at = grid_[cell];
    while (at >= slabs_) at = step(at, cos_theta_o, others);
    return at;
  }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t max_others = 3;

  // A child below slabs_ is a slab; any other is the node `child - slabs_`. theta_o is compared by its negative
  // cosine, which ascends with it.
  struct Node {
    float split = 0;
    std::uint32_t axis = 0, lower = 0, upper = 0;
  };
  std::uint32_t step(std::uint32_t at, float cos_theta_o, const float* others) const {
    const Node& node = nodes_[at - slabs_];
    const float first = -cos_theta_o;
    const float* key = node.axis == 0 ? &first : others + (node.axis - 1);
    return *key >= node.split ? node.upper : node.lower;
  }

  // How many of ascending borders are at or below x. Cells, equal ones or those of the bits of a float, know how
  // many lie before them: what ascends with x does so whatever the rounding. As a rule one border is left to
  // compare, without a branch.
  struct Axis {
    bool by_bits = false;
    int shift = 0;
    std::uint32_t first = 0, most = 0;  // by bits: of the lowest and of the highest place
    float lo = 0, per_unit = 0, last = 0;
    std::size_t stride = 0;
    std::vector<float> borders;  // and infinity
    std::vector<std::uint16_t> guide;
    std::size_t cell(float x) const {
      if (by_bits) return (std::clamp(std::bit_cast<std::uint32_t>(x), first, most) - first) >> shift;
      return std::size_t(clamp((x - lo) * per_unit, 0.f, last));
    }
    std::size_t operator()(float x) const {
      std::size_t i = guide[cell(x)];
      i += std::size_t(borders[i] <= x);
      while (borders[i] <= x) ++i;
      return i;
    }
  };
  class Making;

  std::uint32_t slabs_ = 0;
  std::size_t others_ = 0;
  CosineLookup cosines_;
  std::array<Axis, max_others> axes_{};
  std::vector<std::uint32_t> grid_;
  std::vector<Node> nodes_;  // in preorder
};

}  // namespace reflectree
