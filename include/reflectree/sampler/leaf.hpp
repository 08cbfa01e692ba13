// SPDX-License-Identifier: Apache-2.0
// One leaf at run time: choosing it, a point in it, the shape across it.
#pragma once

#include "reflectree/brdf/shading_geometry.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/packed_sampler.hpp"

namespace reflectree::detail {

struct UnpackedCell {
  float x0, y0, width, height, inverse_area;  // in square coordinates; 1 / share of the square
};
REFLECTREE_INLINE UnpackedCell unpack(PackedCell cell, bool half) {
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
REFLECTREE_INLINE const PackedLeaf& choose_leaf(const PackedSlab& slab, const PackedLeaf* leaves,
                                                std::uint64_t random) {
  const Product bucket = multiply(random, slab.count);
  const PackedLeaf& leaf = leaves[bucket.high];
  const std::uint64_t own =
      std::uint64_t(0) - std::uint64_t(multiply(bucket.low, slab.bucket).high < leaf.threshold);
  return leaves[(bucket.high & own) | (leaf.alias & ~own)];  // a branch would be a coin toss
}

// The inverse of the CDF of the density (1 + g s) / 2 on [-1, 1], returned as (s + 1) / 2 in [0, 1].
REFLECTREE_INLINE float sample_linear(float slope, float u) {
  const float a = 1 - slope, b = 1 + slope;
  return min(2 * u / (a + sqrt(lerp(u, a * a, b * b))), 1.f);
}
REFLECTREE_INLINE float linear_cdf(float slope, float t) { return t * (1 - slope * (1 - t)); }

// A point of a leaf, and there majorant * q or density * q: per share of the square.
struct PointInLeaf {
  Vec2<float> p;
  float height;
};
REFLECTREE_INLINE PointInLeaf point_at(const PackedSlab& slab, const PackedLeaf& leaf, bool half, float tx,
                                       float ty) {
  const UnpackedCell cell = unpack(leaf.cell, half);
  const float gx = float(leaf.slope_x) * (1.f / 64),
              gy = float(leaf.slope_y) * (1.f / 64);  // twice the slopes
  return {{cell.x0 + cell.width * tx, cell.y0 + cell.height * ty},
          slab.unit * float(leaf.mass) * cell.inverse_area * ((1 - 0.5f * gx) + gx * tx) *
              ((1 - 0.5f * gy) + gy * ty)};
}

// Drawn from the shape q by its inverse CDF: monotone in both uniforms.
REFLECTREE_INLINE PointInLeaf place(const PackedSlab& slab, const PackedLeaf& leaf, bool half, float ux,
                                    float uy) {
  return point_at(slab, leaf, half, sample_linear(float(leaf.slope_x) / 128, ux),
                  sample_linear(float(leaf.slope_y) / 128, uy));
}

// Drawn from 1 + g s, g = slope / 128, without root or division: with probability |g| the larger (or, for
// g < 0, the smaller) of two uniforms, else the first. The probability is exact in 7 bits.
REFLECTREE_INLINE float sample_linear(std::int8_t slope, std::uint32_t first, std::uint32_t second) {
  // In integers, whose minima, maxima and selections compile to no branch.
  const std::uint32_t a = first >> 8U, b = second >> 8U;
  const std::uint32_t low = a < b ? a : b, high = a ^ b ^ low;
  const std::uint32_t falling = std::uint32_t(0) - std::uint32_t(slope < 0);
  const std::uint32_t other = high ^ ((high ^ low) & falling);
  const std::uint32_t mixed =
      std::uint32_t(0) - std::uint32_t(int(first & 127U) < (slope < 0 ? -int(slope) : int(slope)));
  return float(a ^ ((a ^ other) & mixed)) * 0x1p-24f;
}
// The same point from random bits; `coin` is a bit that the point does not use.
template <RandomBits U>
REFLECTREE_INLINE PointInLeaf place(const PackedSlab& slab, const PackedLeaf& leaf, bool half, U& u,
                                    bool& coin) {
  const std::uint32_t x0 = u(), x1 = u(), y0 = u(), y1 = u();
  coin = x1 & 1U;
  return point_at(slab, leaf, half, sample_linear(leaf.slope_x, x0, x1), sample_linear(leaf.slope_y, y0, y1));
}

// Half squares: the coin that chooses the sign of wi.y, without a branch.
REFLECTREE_INLINE void mirror(ShadingGeometry<float>& g, bool negative) {
  const std::uint32_t sign = std::uint32_t(negative) << 31U;
  g.wi.y = std::bit_cast<float>(std::bit_cast<std::uint32_t>(g.wi.y) ^ sign);
  g.wh.y = std::bit_cast<float>(std::bit_cast<std::uint32_t>(g.wh.y) ^ sign);
}

// Systematic division: visits n leaves in order, each as often as n equidistant points with a common random
// offset fall into its share of the mass (n share, rounded up or down).
template <RandomBits U, class Visit>
void divide(const PackedSlab& slab, const PackedLeaf* leaves, std::size_t n, U& u, Visit&& visit) {
  const double total = double(slab.bucket) * double(slab.count), step = total / double(n);
  const double offset = to_unit_double(u()) * step;
  double upper = double(leaves[0].mass);
  std::uint32_t i = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double at = offset + double(k) * step;
    while (at >= upper && i + 1 < slab.count) upper += double(leaves[++i].mass);
    visit(leaves[i]);
  }
}

}  // namespace reflectree::detail
