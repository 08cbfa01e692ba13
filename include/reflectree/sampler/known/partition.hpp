// SPDX-License-Identifier: Apache-2.0
// A partition of the known coordinates into slabs: a binary tree over a short list of named coordinates
// (theta_o; of anisotropic functions also phi_o; of families also one or two parameters).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace reflectree {

struct KnownCoordinate {
  std::string name;  // "theta_o", "phi_o"
  float lo = 0, hi = 1;
  friend bool operator==(const KnownCoordinate&, const KnownCoordinate&) = default;
};

struct Partition {
  static constexpr std::uint8_t leaf = 0xff;
  std::vector<KnownCoordinate> coordinates;
  std::vector<std::uint8_t> axis;  // preorder: coordinate that a node splits, or `leaf`
  std::vector<float> split;        // of each inner node, in preorder; lower half first
  friend bool operator==(const Partition&, const Partition&) = default;
};

// The number of slabs (leaves); slabs are numbered in preorder.
std::size_t slab_count(const Partition& partition);
// The slab that holds a point of the known coordinates; upper borders belong to the upper slab.
std::size_t find_slab(const Partition& partition, std::span<const float> known);
// The box of every slab: lo and hi per coordinate, slab after slab.
struct SlabBox {
  std::vector<float> lo, hi;
};
std::vector<SlabBox> slab_boxes(const Partition& partition);
// Throws Error unless the tree is complete, finite and every split lies inside its box.
void validate(const Partition& partition);

}  // namespace reflectree
