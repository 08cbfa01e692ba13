// SPDX-License-Identifier: Apache-2.0
#include "canonical.hpp"

#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree::detail {

namespace {

// Slabs that lie one after the other as they come from halving: somewhere a straight cut parts them. The cut
// nearest to the middle.
struct Cut {
  std::size_t slab = 0;
  std::size_t axis = 0;  // of the boxes
};
Cut cut_of(const std::vector<Slab>& slabs, std::size_t begin, std::size_t end) {
  const auto parts = [&](std::size_t at, std::size_t box_axis) {
    const std::size_t axis = slabs[at].box.slot[box_axis];
    const float border = slabs[at].box.lo[axis];
    for (std::size_t s = begin; s < end; ++s) {
      if (s < at ? slabs[s].box.hi[axis] > border : slabs[s].box.lo[axis] < border) return false;
    }
    return true;
  };
  const std::size_t middle = (begin + end) / 2;
  for (std::size_t away = 0; away < end - begin; ++away) {
    for (const std::size_t at : {middle + away, middle - away}) {
      for (std::size_t axis = 0; axis < std::size_t(slabs[begin].box.axes); ++axis) {
        if (at > begin && at < end && parts(at, axis)) return {at, axis};
      }
    }
  }
  throw Error("slabs that no cut parts", "builder", "report this: it cannot be");
}

void add_borders(const std::vector<Slab>& slabs, std::size_t begin, std::size_t end, Partition& partition) {
  if (end - begin == 1) {
    partition.axis.push_back(Partition::leaf);
    return;
  }
  const Cut cut = cut_of(slabs, begin, end);
  partition.axis.push_back(std::uint8_t(cut.axis));
  partition.split.push_back(slabs[cut.slab].box.lo[slabs[cut.slab].box.slot[cut.axis]]);
  add_borders(slabs, begin, cut.slab, partition);
  add_borders(slabs, cut.slab, end, partition);
}

}  // namespace

Partition partition_of(const std::vector<Slab>& slabs, const std::vector<KnownParameter>& parameters) {
  Partition partition;
  partition.coordinates = {{"theta_o", 0, theta_max}};
  const KnownBox& last = slabs.back().box;
  if (last.axes > 1 && last.slot[1] == 1) partition.coordinates.push_back({"phi_o", 0, last.hi[1]});
  for (const KnownParameter& p : parameters)
    partition.coordinates.push_back({p.range.name, lowest(p), highest(p)});
  add_borders(slabs, 0, slabs.size(), partition);
  return partition;
}

namespace {

std::vector<TreeSplit> preorder(const Slab& slab) {
  std::vector<TreeSplit> order;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const Node& node = slab.nodes[stack.back()];
    stack.pop_back();
    order.push_back(node.split);
    if (node.split != TreeSplit::leaf) stack.push_back(node.child + 1), stack.push_back(node.child);
  }
  return order;
}

// Integer masses, rounded up, that sum to less than 2^32; returns the unit.
double quantise(const std::vector<double>& cost, std::vector<std::uint32_t>& mass) {
  double total = 0;
  for (const double c : cost) total += c;
  const double unit = max(total, 1e-30) / (4294967295. - 2. * double(cost.size()) - 2);
  for (const double c : cost) mass.push_back(std::uint32_t(max(std::ceil(c / unit), 1.)));
  return unit;
}

// Nodes, slopes and quantised masses; returns the unit of mass. No leaf loses support, whatever its grid saw.
double fill(CanonicalTree& tree, const Slab& slab) {
  tree.nodes = preorder(slab);
  std::vector<double> cost;
  for (const std::uint32_t i : leaves_in_order(slab)) {
    const Leaf& leaf = slab.nodes[i].leaf;
    cost.push_back(double(area_share(leaf.cell)) * double(max(leaf.height, floor_share)));
    tree.slope_x.push_back(std::int8_t(std::lround(leaf.slope_x * 128)));
    tree.slope_y.push_back(std::int8_t(std::lround(leaf.slope_y * 128)));
  }
  return quantise(cost, tree.mass);
}

}  // namespace

std::size_t slab_index(const Partition& partition, const Viewer& viewer, const KnownBox& whole) {
  const Known known = known_of(viewer, whole);
  std::array<float, known_slots> along{};
  for (int axis = 0; axis < whole.axes; ++axis)
    along[std::size_t(axis)] = known[whole.slot[std::size_t(axis)]];
  return find_slab(partition, along);
}

MajorantTree majorant_tree(const Slab& slab) {
  MajorantTree tree;
  const double unit = fill(tree, slab);
  tree.volume = std::nextafter(float(unit * total_mass(tree)), 1e30f);
  return tree;
}

void set_volumes(MajorantTree& tree, const std::vector<double>& volumes) {
  tree.mass.clear();
  const double unit = quantise(volumes, tree.mass);
  tree.volume = std::nextafter(float(unit * total_mass(tree)), 1e30f);
}

DensityTree density_tree(const Slab& slab) {
  DensityTree tree;
  fill(tree, slab);
  return tree;
}

}  // namespace reflectree::detail
