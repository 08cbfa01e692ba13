// SPDX-License-Identifier: Apache-2.0
// PCG32 (O'Neill 2014, pcg-random.org, XSH-RR 64/32): small, seekable, the same on every machine.
#pragma once

#include <concepts>
#include <cstdint>

namespace reflectree {

// Samplers draw 32 uniform random bits at a time: 24-bit floats bend the probabilities of leaves.
template <class U>
concept RandomBits = requires(U& u) {
  { u() } -> std::same_as<std::uint32_t>;
};

class Pcg32 {
 public:
  using result_type = std::uint32_t;
  explicit constexpr Pcg32(std::uint64_t seed = 0x853c49e6748fea9bULL, std::uint64_t stream = 0)
      : increment_((stream << 1U) | 1U) {
    (*this)();
    state_ += seed;
    (*this)();
  }
  static constexpr std::uint32_t min() { return 0; }
  static constexpr std::uint32_t max() { return 0xffffffffU; }
  constexpr std::uint32_t operator()() {
    const std::uint64_t old = state_;
    state_ = old * multiplier + increment_;
    const auto xorshifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<std::uint32_t>(old >> 59U);
    return (xorshifted >> rotation) | (xorshifted << ((32U - rotation) & 31U));
  }
  // Jumps `delta` steps ahead in O(log delta) (Brown 1994).
  constexpr void advance(std::uint64_t delta) {
    std::uint64_t m = multiplier, p = increment_, total_m = 1, total_p = 0;
    for (; delta > 0; delta >>= 1U) {
      if (delta & 1U) {
        total_m *= m;
        total_p = total_p * m + p;
      }
      p *= m + 1;
      m *= m;
    }
    state_ = total_m * state_ + total_p;
  }

 private:
  static constexpr std::uint64_t multiplier = 6364136223846793005ULL;
  std::uint64_t state_ = 0, increment_;
};

// 32 random bits as a float in [0, 1), never 1.
constexpr float to_unit_float(std::uint32_t bits) { return float(bits >> 8U) * 0x1p-24f; }
// 32 random bits as a double in [0, 1).
constexpr double to_unit_double(std::uint32_t bits) { return double(bits) * 0x1p-32; }

}  // namespace reflectree
