// SPDX-License-Identifier: Apache-2.0
#include "slab.hpp"

#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

Slab make_slab(const KnownBox& box, const AlbedoTable& table, const Field& field) {
  Slab slab{box, {}, {}, {Node{}}};
  // Just inside the borders, where a neighbour's kink does not reach.
  const auto viewer = [&](Known share) {
    for (float& t : share) t = clamp(t, 1e-4f, 1 - 1e-4f);
    return viewer_at(box.at(share));
  };
  const auto albedo = [&](Direction wo) {
    return field.frame.isotropic() ? albedo_at(table, wo.z) : albedo_at(table, wo.z, azimuth_of(wo));
  };
  constexpr float weights[views_per_axis] = {1.f / 6, 4.f / 6, 1.f / 6};
  const std::size_t across = box.axes > 1 ? views_per_axis : 1;
  for (std::size_t k = 0; k < views_per_axis * across; ++k) {
    const std::array<std::size_t, 2> group{k % views_per_axis, k / views_per_axis};
    const Known place{0.5f * float(group[0]), 0.5f * float(group[1])};
    const float weight = weights[group[0]] * (across > 1 ? weights[group[1]] : 1);
    const Direction wo = viewer(place);
    slab.views.push_back({place, group, weight, box.at(place), wo, albedo(wo)});
  }
  // The landmarks' way through the slab.
  const auto travel = [&](std::size_t i, const std::vector<Landmark>& first,
                          const std::vector<Landmark>& last) {
    if (i >= first.size() || i >= last.size()) return 0.f;
    return max(abs(first[i].p.x - last[i].p.x), abs(first[i].p.y - last[i].p.y));
  };
  const float middle = across > 1 ? 0.5f : 0.f;
  const std::vector<Landmark> low = field.landmarks(viewer({0, middle})),
                              high = field.landmarks(viewer({1, middle}));
  std::vector<Landmark> left, right;
  if (across > 1) left = field.landmarks(viewer({0.5f, 0})), right = field.landmarks(viewer({0.5f, 1}));
  const int steps = across > 1 ? 4 : 12, rows = across > 1 ? 4 : 0;
  for (int row = 0; row <= rows; ++row) {
    for (int step = 0; step <= steps; ++step) {
      const Known share{float(step) / float(steps), rows ? float(row) / float(rows) : 0.f};
      const Direction wo = viewer(share);
      const std::vector<Landmark> here = field.landmarks(wo);
      for (std::size_t i = 0; i < here.size(); ++i) {
        slab.marks.push_back(
            {{wo, here[i].p}, albedo(wo), box.at(share), {travel(i, low, high), travel(i, left, right)}});
      }
    }
  }
  return slab;
}

std::vector<std::uint32_t> leaves_in_order(const Slab& slab) {
  std::vector<std::uint32_t> order, stack{0};
  while (!stack.empty()) {
    const std::uint32_t i = stack.back();
    stack.pop_back();
    const Node& node = slab.nodes[i];
    if (node.split == TreeSplit::leaf) {
      order.push_back(i);
    } else {
      stack.push_back(node.child + 1);
      stack.push_back(node.child);
    }
  }
  return order;
}

std::uint32_t leaf_at(const Slab& slab, Vec2<float> p, const Domain& domain) {
  std::uint32_t i = 0;
  while (slab.nodes[i].split != TreeSplit::leaf) {
    const std::uint32_t child = slab.nodes[i].child;
    const Box upper = box_of(slab.nodes[child + 1].leaf.cell, domain);
    const bool up = slab.nodes[i].split == TreeSplit::x ? p.x >= upper.x0 : p.y >= upper.y0;
    i = child + std::uint32_t(up);
  }
  return i;
}

float total(const Slab& slab, float Leaf::*member) {
  double sum = 0;
  for (const Node& node : slab.nodes) {
    if (node.split == TreeSplit::leaf) sum += double(node.leaf.*member);
  }
  return float(sum);
}

float total_known_cost(const Slab& slab, int axis) {
  double sum = 0;
  for (const Node& node : slab.nodes) {
    if (node.split == TreeSplit::leaf) sum += double(node.leaf.known_cost[std::size_t(axis)]);
  }
  return float(sum);
}

SlabTotal total_of(const Slab& slab) {
  SlabTotal total;
  for (const Node& node : slab.nodes) {
    if (node.split == TreeSplit::leaf)
      total.cost += double(node.leaf.cost), total.ideal += double(node.leaf.ideal);
  }
  return total;
}

void split_leaf(Slab& slab, std::uint32_t index, const Domain& domain) {
  const auto child = std::uint32_t(slab.nodes.size());
  Leaf leaf = slab.nodes[index].leaf;
  slab.nodes[index].split = leaf.split_x ? TreeSplit::x : TreeSplit::y;
  slab.nodes[index].child = child;
  DyadicCell& cell = leaf.cell;
  ++(leaf.split_x ? cell.level_x : cell.level_y);
  std::uint32_t& position = leaf.split_x ? cell.ix : cell.iy;
  position *= 2;
  for (int half = 0; half < 2; ++half, ++position) {
    Leaf inherited;
    inherited.cell = cell;
    if (contains(box_of(cell, domain), leaf.seen_at)) {
      inherited.note(leaf.seen, leaf.seen_by, leaf.seen_at);
    }
    slab.nodes.push_back({TreeSplit::leaf, 0, inherited});
  }
}

}  // namespace reflectree::detail
