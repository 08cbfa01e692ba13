// SPDX-License-Identifier: Apache-2.0
// One leaf at run time: choosing it, a point in it, the shape across it.
#pragma once

#include <bit>

#include "reflectree/math/random.hpp"
#include "reflectree/sampler/square/packed_tree.hpp"

namespace reflectree::detail {

// The high and low halves of a 64 x 64 bit product: chooses among n with a bias below 2^-64 n.
struct Product {
  std::uint64_t high, low;
};
REFLECTREE_INLINE Product multiply(std::uint64_t a, std::uint64_t b) {
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
REFLECTREE_INLINE std::uint64_t bits64(U& u) {
  const std::uint64_t high = u();
  return (high << 32U) | u();
}

// A leaf in proportion to its mass, by the alias table (Walker 1977) in integers: no rounding bends it.
// `spare`: 64 random bits less what the choice used up, about 32 + log2(count); the high ones are good.
struct ChosenLeaf {
  const PackedLeaf& leaf;
  std::uint64_t spare;
};
REFLECTREE_INLINE ChosenLeaf choose_leaf(const PackedSlab& slab, const PackedLeaf* leaves,
                                         std::uint64_t random) {
  const Product bucket = multiply(random, slab.count);
  const PackedLeaf& leaf = leaves[bucket.high];
  const Product position = multiply(bucket.low, slab.bucket);
  const std::uint64_t own = std::uint64_t(0) - std::uint64_t(position.high < leaf.threshold);
  // A branch would be a coin toss.
  return {leaves[(bucket.high & own) | (leaf.alias & ~own)], position.low};
}

// The inverse of the CDF of the density (1 + g s) / 2 on [-1, 1], returned as (s + 1) / 2 in [0, 1].
template <class T>
REFLECTREE_INLINE T sample_linear(T slope, T u) {
  const T a = T(1) - slope, b = T(1) + slope;
  return min(T(2) * u / (a + sqrt(linear_mix(u, a * a, b * b))), T(1));
}
REFLECTREE_INLINE float linear_cdf(float slope, float t) { return t * (1 - slope * (1 - t)); }

// 2^exponent, exactly, by building the float.
REFLECTREE_INLINE float power_of_two(int exponent) {
  return std::bit_cast<float>(std::uint32_t(127 + exponent) << 23U);
}

// A leaf unpacked: its cell starts at (x, y) and is width by length, in square coordinates.
template <class T>
struct LeafCell {
  T x, y, width, length;
  T slope_x, slope_y;  // of the shape (1 + slope_x s)(1 + slope_y s'), s and s' in [-1, 1] across the cell
  T height;
};
REFLECTREE_INLINE LeafCell<float> unpack(const PackedLeaf& leaf, bool half) {
  // Without its lowest bit the middle is where the cell starts.
  const std::uint32_t x = leaf.x, y = leaf.y;
  const int start_x = int(x & (x - 1)), start_y = int(y & (y - 1));
  return {float(start_x - 0x8000) * 0x1p-15f,
          half ? float(start_y) * 0x1p-16f : float(start_y - 0x8000) * 0x1p-15f,
          power_of_two(std::countr_zero(x) - 14),
          power_of_two(std::countr_zero(y) - (half ? 15 : 14)),
          float(leaf.slope_x) * (1.f / 128),
          float(leaf.slope_y) * (1.f / 128),
          leaf.height};
}

// A point of a leaf, and there majorant * q or density * q: per share of the square.
template <class T>
struct PointInLeafT {
  Vec2<T> p;
  T height;
};
using PointInLeaf = PointInLeafT<float>;
// tx, ty in [0, 1] across the leaf. The sum with the corner comes last, where small cells keep their precision.
template <class T>
REFLECTREE_INLINE PointInLeafT<T> point_at(const LeafCell<T>& cell, T tx, T ty) {
  const T shape_x = (T(1) - cell.slope_x) + T(2) * cell.slope_x * tx;
  const T shape_y = (T(1) - cell.slope_y) + T(2) * cell.slope_y * ty;
  return {{cell.x + cell.width * tx, cell.y + cell.length * ty}, cell.height * shape_x * shape_y};
}
REFLECTREE_INLINE PointInLeaf point_at(const PackedLeaf& leaf, bool half, float tx, float ty) {
  return point_at(unpack(leaf, half), tx, ty);
}

// Drawn from the shape q by its inverse CDF: monotone in both uniforms.
REFLECTREE_INLINE PointInLeaf place(const PackedLeaf& leaf, bool half, float ux, float uy) {
  return point_at(leaf, half, sample_linear(float(leaf.slope_x) / 128, ux),
                  sample_linear(float(leaf.slope_y) / 128, uy));
}

// Drawn from 1 + g s, g = slope / 128, without root or division: with probability |g|, exact in 7 bits, the
// larger (for g < 0, the smaller) of two uniforms, else the first.
REFLECTREE_INLINE float mix_linear(std::int8_t slope, std::uint32_t first, std::uint32_t second) {
  // In integers, whose minima, maxima and selections compile to no branch.
  const std::uint32_t a = first >> 8U, b = second >> 8U;
  const std::uint32_t low = a < b ? a : b, high = a ^ b ^ low;
  const std::uint32_t falling = std::uint32_t(0) - std::uint32_t(slope < 0);
  const std::uint32_t other = high ^ ((high ^ low) & falling);
  const std::uint32_t mixed =
      std::uint32_t(0) - std::uint32_t(int(first & 127U) < (slope < 0 ? -int(slope) : int(slope)));
  return float(a ^ ((a ^ other) & mixed)) * 0x1p-24f;
}
// From 64 random bits and those that the choice of the leaf has to spare; `coin` is a bit left over. The
// azimuth is wanted first and is mixed; the root of the radius hides behind it.
template <RandomBits U>
REFLECTREE_INLINE PointInLeaf place(const ChosenLeaf& chosen, bool half, U& u, bool& coin) {
  const std::uint32_t x = u(), y = u();
  coin = y & 1U;
  const float tx = mix_linear(chosen.leaf.slope_x, x, std::uint32_t(chosen.spare >> 32U));
  return point_at(chosen.leaf, half, tx,
                  sample_linear(float(chosen.leaf.slope_y) * (1.f / 128), to_unit_float(y)));
}

// Systematic division: visits n leaves in order, each as often as n equidistant points with a common random
// offset fall into its share of the mass (n share, rounded up or down).
template <RandomBits U, class Visit>
void divide(const PackedSlab& slab, const PackedLeaf* leaves, std::size_t n, U& u, Visit&& visit) {
  const double step = double(slab.volume) / double(n), offset = to_unit_double(u()) * step;
  const auto share = [leaves](std::uint32_t k) {
    return double(leaves[k].height) * double(area_of(leaves[k]));
  };
  double upper = share(0);
  std::uint32_t i = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double at = offset + double(k) * step;
    while (at >= upper && i + 1 < slab.count) upper += share(++i);
    visit(ChosenLeaf{leaves[i], bits64(u)});
  }
}

}  // namespace reflectree::detail
