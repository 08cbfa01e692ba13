// SPDX-License-Identifier: Apache-2.0
// Which slab holds a viewer, in a few instructions.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace reflectree {

// Directions closer to the horizon than this (89.9996 degrees) get "no sample".
inline constexpr float min_cos_theta_o = 0x1p-17f;

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
  int shift_ = 18;              // 18: 32 entries per octave
  std::vector<float> borders_;  // the last one is above 1
  std::vector<std::uint16_t> guide_;
};

}  // namespace reflectree
