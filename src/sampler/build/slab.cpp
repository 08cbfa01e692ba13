// SPDX-License-Identifier: Apache-2.0
#include "slab.hpp"

#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

Slab make_slab(float theta_lo, float theta_hi, const AlbedoTable& table, const Field& field) {
  constexpr int mark_steps = 12;
  Slab slab{theta_lo, theta_hi, {}, {}, {Node{}}};
  // Just inside the borders, where a neighbour's kink does not reach.
  const auto cosine_at = [&](float t) {
    return clamp(cos(linear_mix(clamp(t, 1e-4f, 1 - 1e-4f), theta_lo, theta_hi)), min_cos_theta_o, 1.f);
  };
  // Simpson's rule.
  constexpr float weights[] = {1.f / 6, 4.f / 6, 1.f / 6};
  for (int k = 0; k < 3; ++k) {
    const float place = 0.5f * float(k), c = cosine_at(place);
    slab.views.push_back({place, weights[k], linear_mix(place, theta_lo, theta_hi), c, albedo_at(table, c)});
  }
  const std::vector<Landmark> first = field.landmarks(cosine_at(0)), last = field.landmarks(cosine_at(1));
  const auto travel = [&](std::size_t i) {
    if (i >= first.size() || i >= last.size()) return 0.f;
    return max(abs(first[i].p.x - last[i].p.x), abs(first[i].p.y - last[i].p.y));
  };
  for (int step = 0; step <= mark_steps; ++step) {
    const float t = float(step) / mark_steps, c = cosine_at(t);
    const std::vector<Landmark> here = field.landmarks(c);
    for (std::size_t i = 0; i < here.size(); ++i) {
      slab.marks.push_back(
          {{c, here[i].p}, albedo_at(table, c), linear_mix(t, theta_lo, theta_hi), travel(i)});
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

float total(const Slab& slab, float Leaf::*member) {
  double sum = 0;
  for (const Node& node : slab.nodes) {
    if (node.split == TreeSplit::leaf) sum += double(node.leaf.*member);
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
      inherited.note(leaf.seen, leaf.seen_theta, leaf.seen_at);
    }
    slab.nodes.push_back({TreeSplit::leaf, 0, inherited});
  }
}

}  // namespace reflectree::detail
