// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/integrators/path_bits.hpp"

#include <bit>

#include "reflectree/math/low_discrepancy.hpp"

namespace reflectree::render {

namespace {

// The finaliser of splitmix64 (Steele, Lea & Flood 2014).
constexpr std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

// Where a random permutation of [0, n) takes i < n. A nested-uniform permutation of the next power of two is
// followed until it lands inside; the turn at the end makes each image exactly uniform.
std::uint32_t permuted(std::uint32_t i, std::uint32_t n, std::uint64_t seed) {
  if (n <= 1) return 0;
  const auto shift = std::uint32_t(std::countl_zero(n - 1));
  do {
    i = owen_scramble(i << shift, std::uint32_t(seed)) >> shift;
  } while (i >= n);
  const std::uint64_t turned = i + (((seed >> 32U) * n) >> 32U);
  return std::uint32_t(turned < n ? turned : turned - n);
}

}  // namespace

// Neighbouring seeds and streams of pcg32 begin with outputs on a lattice:
// samples and pixels would not be independent.
PathBits::PathBits(PointSet set, std::uint64_t seed, std::uint64_t pixel, std::uint32_t sample)
    : set_(set), index_(sample), rest_(mixed(mixed(seed * 0x9e3779b97f4a7c15ULL + sample) + pixel), pixel) {
  if (set.kind == PointSet::Kind::independent) return;
  left_ = 4;
  scramble_ = std::uint32_t(mixed(mixed(seed + 0x9e3779b97f4a7c15ULL) + pixel) >> 32U);
}

std::uint32_t PathBits::coordinate() {
  const std::uint32_t dimension = dimension_++;
  --left_;
  if (set_.kind == PointSet::Kind::sobol) {
    if (!placed_) in_block_ = sobol_index_in_block(index_, dimension / 4, scramble_), placed_ = true;
    return scrambled_sobol_in_block(in_block_, dimension, scramble_);
  }
  const std::uint32_t cells = set_.columns * set_.rows, round = index_ / cells;
  const std::uint64_t pair = (std::uint64_t(scramble_) << 32U) + dimension / 2;
  const std::uint32_t cell = permuted(index_ % cells, cells, mixed(mixed(pair) + round));
  const bool first = dimension % 2 == 0;
  const std::uint32_t n = first ? set_.columns : set_.rows, i = first ? cell % n : cell / set_.columns;
  return std::uint32_t(((std::uint64_t(i) << 32U) + rest_()) / n);
}

PathBits PathBits::branch(std::uint32_t k, std::uint32_t n) {
  PathBits b = *this;
  b.index_ = index_ * n + k, b.left_ = 0;
  const std::uint64_t seed = rest_();
  b.rest_ = Pcg32((seed << 32U) | rest_(), k);
  return b;
}

}  // namespace reflectree::render
