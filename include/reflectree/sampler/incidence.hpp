// SPDX-License-Identifier: Apache-2.0
// Everything about wo that a sampler needs, computed once: its local frame, slabs and albedo.
#pragma once

#include "reflectree/math/random.hpp"
#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree {

struct Incidence {
  Direction wo;            // turned into the x-z plane
  float cos_phi, sin_phi;  // of the turn back
  float albedo;            // a(wo) of the target
};

// False is "no sample": wo below or at the horizon, not finite, or albedo 0.
inline bool find_incidence(const PackedSampler& packed, Direction wo, Incidence& out) {
  if (!(wo.z >= min_cos_theta_o && wo.z <= 1.00001f)) return false;
  const float sin_theta = sqrt(wo.x * wo.x + wo.y * wo.y);
  if (!(sin_theta <= 1.00001f)) return false;
  const float inverse = sin_theta > 0 ? 1 / sin_theta : 0.f;
  const float cos_theta = min(wo.z, 1.f);
  out.wo = {sin_theta, 0, cos_theta};
  out.cos_phi = sin_theta > 0 ? wo.x * inverse : 1.f;
  out.sin_phi = wo.y * inverse;
  out.albedo = packed.albedo_at(cos_theta);
  return out.albedo > 0;
}

inline Direction from_incidence(const Incidence& in, Direction w) {
  return {w.x * in.cos_phi - w.y * in.sin_phi, w.x * in.sin_phi + w.y * in.cos_phi, w.z};
}
inline Direction to_incidence(const Incidence& in, Direction w) {
  return {w.x * in.cos_phi + w.y * in.sin_phi, w.y * in.cos_phi - w.x * in.sin_phi, w.z};
}

namespace detail {

struct UnpackedCell {
  float x0, y0, width, height, inverse_area;  // in square coordinates; 1 / share of the square
};
inline UnpackedCell unpack(PackedCell cell, bool half) {
  const int level_x = int(std::bit_width(unsigned(cell.x))) - 1;  // unsigned in libc++ 14
  const int level_y = int(std::bit_width(unsigned(cell.y))) - 1;
  // 2^-level, exactly, by building the float's exponent.
  const float wx = std::bit_cast<float>(std::uint32_t(128 - level_x) << 23U);
  const float wy = std::bit_cast<float>(std::uint32_t((half ? 127 : 128) - level_y) << 23U);
  const float y_min = half ? 0.f : -1.f;
  return {-1 + float(cell.x - (1 << level_x)) * wx, y_min + float(cell.y - (1 << level_y)) * wy, wx, wy,
          std::bit_cast<float>(std::uint32_t(127 + level_x + level_y) << 23U)};
}

// The high and low halves of a 64 x 64 bit product: chooses among n with a bias below 2^-64 n.
struct Product {
  std::uint64_t high, low;
};
inline Product multiply(std::uint64_t a, std::uint64_t b) {
#ifdef __SIZEOF_INT128__
  __extension__ typedef unsigned __int128 Wide;
  const Wide p = Wide(a) * b;
  return {std::uint64_t(p >> 64U), std::uint64_t(p)};
#else
  const std::uint64_t a0 = a & 0xffffffffU, a1 = a >> 32U, b0 = b & 0xffffffffU, b1 = b >> 32U;
  const std::uint64_t p00 = a0 * b0, p01 = a0 * b1, p10 = a1 * b0, p11 = a1 * b1;
  const std::uint64_t middle = (p00 >> 32U) + (p01 & 0xffffffffU) + (p10 & 0xffffffffU);
  return {p11 + (p01 >> 32U) + (p10 >> 32U) + (middle >> 32U), (middle << 32U) | (p00 & 0xffffffffU)};
#endif
}

template <RandomBits U>
std::uint64_t bits64(U& u) {
  const std::uint64_t high = u();
  return (high << 32U) | u();
}

// A leaf in proportion to its mass, by the alias table (Walker 1977) in integers: no rounding bends it.
template <class Slab, class Leaf>
const Leaf& choose_leaf(const Slab& slab, const Leaf* leaves, std::uint64_t random) {
  const Product bucket = multiply(random, slab.count);
  const Leaf& leaf = leaves[bucket.high];
  return multiply(bucket.low, slab.bucket).high < leaf.threshold ? leaf : leaves[leaf.alias];
}

}  // namespace detail
}  // namespace reflectree
