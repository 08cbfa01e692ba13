// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/partition.hpp"

#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree {

std::size_t slab_count(const Partition& partition) {
  std::size_t count = 0;
  for (const std::uint8_t axis : partition.axis) count += axis == Partition::leaf;
  return count;
}

std::size_t find_slab(const Partition& partition, std::span<const float> known) {
  // Preorder: the lower subtree follows its node; skipping it means counting its leaves.
  std::size_t node = 0, inner = 0, slab = 0;
  while (partition.axis[node] != Partition::leaf) {
    const bool up = known[partition.axis[node]] >= partition.split[inner];
    ++node, ++inner;
    if (!up) continue;
    for (std::size_t open = 1; open > 0; ++node) {
      if (partition.axis[node] == Partition::leaf) {
        --open, ++slab;
      } else {
        ++open, ++inner;
      }
    }
  }
  return slab;
}

std::vector<SlabBox> slab_boxes(const Partition& partition) {
  SlabBox root;
  for (const KnownCoordinate& c : partition.coordinates) root.lo.push_back(c.lo), root.hi.push_back(c.hi);
  std::vector<SlabBox> boxes, stack{root};
  std::size_t inner = 0;
  for (const std::uint8_t axis : partition.axis) {
    SlabBox box = std::move(stack.back());
    stack.pop_back();
    if (axis == Partition::leaf) {
      boxes.push_back(std::move(box));
      continue;
    }
    const float split = partition.split[inner++];
    SlabBox upper = box;
    box.hi[axis] = upper.lo[axis] = split;
    stack.push_back(std::move(upper));
    stack.push_back(std::move(box));
  }
  return boxes;
}

void validate(const Partition& partition) {
  const auto fail = [](const std::string& what) {
    throw Error(what, "partition of the known coordinates", "build the sampler again");
  };
  if (partition.coordinates.empty() || partition.coordinates.size() > 8) fail("needs 1 to 8 coordinates");
  for (const KnownCoordinate& c : partition.coordinates) {
    if (!(std::isfinite(c.lo) && std::isfinite(c.hi) && c.lo < c.hi))
      fail("the range of " + c.name + " is empty");
  }
  std::size_t open = 1, inner = 0;
  for (const std::uint8_t axis : partition.axis) {
    if (open == 0) fail("the tree goes on after its end");
    if (axis == Partition::leaf) {
      --open;
    } else {
      if (axis >= partition.coordinates.size()) fail("a node splits an unknown coordinate");
      ++open, ++inner;
    }
  }
  if (open != 0) fail("the tree is incomplete");
  if (inner != partition.split.size()) fail("the number of splits does not fit the tree");
  std::vector<SlabBox> stack{{{}, {}}};
  for (const KnownCoordinate& c : partition.coordinates) {
    stack[0].lo.push_back(c.lo), stack[0].hi.push_back(c.hi);
  }
  inner = 0;
  for (const std::uint8_t axis : partition.axis) {
    SlabBox box = std::move(stack.back());
    stack.pop_back();
    if (axis == Partition::leaf) continue;
    const float split = partition.split[inner++];
    if (!(split > box.lo[axis] && split < box.hi[axis])) fail("a split lies outside its box");
    SlabBox upper = box;
    box.hi[axis] = upper.lo[axis] = split;
    stack.push_back(std::move(upper));
    stack.push_back(std::move(box));
  }
}

}  // namespace reflectree
