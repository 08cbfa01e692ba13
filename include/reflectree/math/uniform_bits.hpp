// SPDX-License-Identifier: Apache-2.0
// Random bits whose first words the caller chooses: stratified or low-discrepancy points enter a sampler
// through them, and what rejection asks for beyond them comes from pcg32.
#pragma once

#include <array>

#include "reflectree/math/random.hpp"

namespace reflectree {

class UniformBits {
 public:
  explicit constexpr UniformBits(Pcg32 rest) : rest_(rest) {}
  // The first two words are the coordinates of a point in the unit square.
  constexpr UniformBits(std::array<std::uint32_t, 2> point, Pcg32 rest)
      : point_(point), used_(0), rest_(rest) {}

  constexpr std::uint32_t operator()() { return used_ < 2 ? point_[used_++] : rest_(); }
  // What is left of the generator, to go on with.
  constexpr Pcg32 rest() const { return rest_; }

 private:
  std::array<std::uint32_t, 2> point_{};
  unsigned used_ = 2;
  Pcg32 rest_;
};

}  // namespace reflectree
