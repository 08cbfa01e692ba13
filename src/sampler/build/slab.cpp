// SPDX-License-Identifier: Apache-2.0
#include "slab.hpp"

#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

Slab make_slab(const KnownBox& box, const AlbedoTable& table, const Field& field) {
  Slab slab{box, {}, {}, {Node{}}};
  // Just inside the borders, where a neighbour's kink does not reach.
  const auto viewer = [&](Shares share) {
    for (float& t : share) t = clamp(t, 1e-4f, 1 - 1e-4f);
    return viewer_at(box.at(share));
  };
  const auto axes = std::size_t(box.axes);
  constexpr float weights[views_per_axis] = {1.f / 6, 4.f / 6, 1.f / 6};
  std::size_t views = 1;
  for (std::size_t a = 0; a < axes; ++a) views *= views_per_axis;
  for (std::size_t k = 0; k < views; ++k) {
    std::array<std::size_t, known_slots> group{};
    Shares place{};
    float weight = 1;
    for (std::size_t a = 0, rest = k; a < axes; ++a, rest /= views_per_axis) {
      group[a] = rest % views_per_axis, place[a] = 0.5f * float(group[a]);
      weight *= weights[group[a]];
    }
    const Viewer at = viewer(place);
    slab.views.push_back({place, group, weight, box.at(place), at, albedo_of(field, table, at)});
  }
  if (!field.patches.empty()) {
    slab.patches = patches_of(field, slab.views);
    return slab;
  }
  // The landmarks' way through the slab, along each axis.
  Shares middle{};
  for (std::size_t a = 1; a < axes; ++a) middle[a] = 0.5f;
  std::array<std::vector<Landmark>, known_slots> low, high;
  for (std::size_t a = 0; a < axes; ++a) {
    Shares share = middle;
    if (axes > 1) share[0] = 0.5f;
    share[a] = 0, low[a] = field.landmarks(viewer(share));
    share[a] = 1, high[a] = field.landmarks(viewer(share));
  }
  const auto travel = [&](std::size_t i) {
    Shares way{};
    for (std::size_t a = 0; a < axes; ++a) {
      if (i >= low[a].size() || i >= high[a].size()) continue;
      way[a] = max(abs(low[a][i].p.x - high[a][i].p.x), abs(low[a][i].p.y - high[a][i].p.y));
    }
    return way;
  };
  constexpr std::array<std::size_t, known_slots> marks_per_axis{13, 5, 3, 3};
  const std::size_t steps = marks_per_axis[axes - 1];
  std::size_t marks = 1;
  for (std::size_t a = 0; a < axes; ++a) marks *= steps;
  for (std::size_t k = 0; k < marks; ++k) {
    Shares share{};
    for (std::size_t a = 0, rest = k; a < axes; ++a, rest /= steps)
      share[a] = float(rest % steps) / float(steps - 1);
    const Viewer at = viewer(share);
    const std::vector<Landmark> here = field.landmarks(at);
    for (std::size_t i = 0; i < here.size(); ++i)
      slab.marks.push_back(
          {field_point(at, here[i].p), albedo_of(field, table, at), box.at(share), travel(i)});
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

double worst_view(const Slab& slab) {
  std::array<double, views_of_two_angles> mean{}, square{};
  double all = 0;
  for (const Node& node : slab.nodes) {
    if (node.split != TreeSplit::leaf) continue;
    const Leaf& leaf = node.leaf;
    const auto area = double(area_share(leaf.cell)), height = double(leaf.height);
    all += area * height;
    for (std::size_t k = 0; k < leaf.of_view.size(); ++k) {
      mean[k] += area * double(leaf.of_view[k].mean);
      square[k] += area * double(leaf.of_view[k].square) / height;
    }
  }
  double worst = 0;
  for (std::size_t k = 0; k < mean.size(); ++k) {
    if (mean[k] > 0) worst = std::max(worst, all * square[k] / sqr(mean[k]) - 1);
  }
  return worst;
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
