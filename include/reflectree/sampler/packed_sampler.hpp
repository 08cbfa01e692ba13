// SPDX-License-Identifier: Apache-2.0
// The run-time layout, made from SamplerData at load: flat arrays, alias tables, guides. Speed work
// changes this and never the file.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "reflectree/sampler/albedo.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree {

// Finds the interval of an ascending list of cosines that holds c. The bits of a positive float grow with
// it, logarithmically by octave and linearly inside: they index a guide that is finest at grazing.
class CosineLookup {
 public:
  CosineLookup() = default;
  explicit CosineLookup(std::vector<float> borders);
  const std::vector<float>& borders() const { return borders_; }
  // i with borders[i] <= c < borders[i + 1], clamped; c in [min_cos_theta_o, 1]. The guide leaves at most one
  // step where it can, taken without a branch.
  std::size_t operator()(float c) const {
    std::size_t i = guide_[(std::bit_cast<std::uint32_t>(c) - base_) >> shift_];
    i += std::size_t(borders_[i + 1] <= c);
    while (borders_[i + 1] <= c) ++i;
    return i;
  }
  std::size_t bytes() const {
    return borders_.size() * sizeof(float) + guide_.size() * sizeof(std::uint16_t);
  }

 private:
  static constexpr std::uint32_t base_ = std::bit_cast<std::uint32_t>(min_cos_theta_o);
  int shift_ = 18;              // 18: 32 entries an octave
  std::vector<float> borders_;  // the last one is above 1
  std::vector<std::uint16_t> guide_;
};

// One leaf. Its cell starts at (x, y) / 2^15 of the root square and is 2^-level of it wide and high.
struct PackedLeaf {
  std::uint32_t threshold = 0;  // of the alias table's bucket with this index
  float height = 0;             // majorant or density, per share of the square
  std::uint16_t alias = 0;
  std::uint16_t x = 0, y = 0;
  std::uint8_t level_x = 0, level_y = 0;
  std::int8_t slope_x = 0, slope_y = 0;
};
static_assert(sizeof(PackedLeaf) == 20);

// The leaf's share of the square.
inline float area_of(const PackedLeaf& leaf) {
  return std::bit_cast<float>(std::uint32_t(127 - leaf.level_x - leaf.level_y) << 23U);
}

struct PackedSlab {
  std::uint32_t first = 0, count = 0;  // leaves
  std::uint32_t first_node = 0;
  std::uint32_t bucket = 0;  // capacity of each bucket of the alias table
  float volume = 0;          // sum of height * area: expected trials, or 1
};

// An inner node of a tree in preorder, without pointers: the subtree of `lower_leaves` leaves below has
// lower_leaves - 1 inner nodes and follows at once; the upper subtree follows that.
struct DescentNode {
  float lower;  // share of the probability
  std::uint32_t lower_leaves : 31, split_x : 1;
};
static_assert(sizeof(DescentNode) == 8);

struct PackedForest {
  CosineLookup lookup;
  std::vector<PackedSlab> slabs;  // in order of ascending cos_theta_o
  std::vector<PackedLeaf> leaves;
  std::vector<DescentNode> nodes;  // one-shot only
  const PackedSlab& slab_at(float cos_theta_o) const { return slabs[lookup(cos_theta_o)]; }
};

struct AlbedoPiece {
  float base, slope;  // albedo = base + slope cos_theta_o
};

struct PackedSampler {
  Domain domain;
  Target target;
  PackedForest exact, one_shot;
  CosineLookup albedo_lookup;
  std::vector<AlbedoPiece> albedo;

  float albedo_at(float cos_theta_o) const {
    const AlbedoPiece& piece = albedo[albedo_lookup(cos_theta_o)];
    return piece.base + piece.slope * cos_theta_o;
  }
};

// Throws Error if the data is not valid.
PackedSampler pack(const SamplerData& data);
// Bytes of the run-time arrays: exact, one-shot and albedo together.
std::size_t bytes_of(const PackedSampler& packed);

}  // namespace reflectree
