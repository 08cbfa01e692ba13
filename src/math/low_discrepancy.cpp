// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/low_discrepancy.hpp"

#include <array>
#include <bit>

namespace reflectree {
namespace {

using Matrix = std::array<std::uint32_t, 32>;  // direction number of each bit of the index

// One row of Joe & Kuo's table: a primitive polynomial over GF(2) of some degree, its inner coefficients
// (highest first), and the first odd numbers m_i.
struct Polynomial {
  unsigned degree;
  std::uint32_t coefficients;
  std::array<std::uint32_t, 3> m;
};

// Direction numbers v_i = m_i / 2^(i+1), continued by the recurrence of the polynomial.
constexpr Matrix directions(const Polynomial& p) {
  Matrix v{};
  for (unsigned i = 0; i < 32; ++i) {
    if (i < p.degree) {
      v[i] = p.m[i] << (31U - i);
      continue;
    }
    v[i] = v[i - p.degree] ^ (v[i - p.degree] >> p.degree);
    for (unsigned k = 1; k < p.degree; ++k) {
      if ((p.coefficients >> (p.degree - 1U - k)) & 1U) v[i] ^= v[i - k];
    }
  }
  return v;
}

constexpr Matrix van_der_corput() {
  Matrix v{};
  for (unsigned i = 0; i < 32; ++i) v[i] = 1U << (31U - i);
  return v;
}

constexpr std::array<Matrix, 4> matrices = {van_der_corput(), directions({1, 0, {1}}),
                                            directions({2, 1, {1, 3}}), directions({3, 1, {1, 3, 1}})};

// What each byte of the index adds: four look-ups in place of a bit at a time.
using ByteTables = std::array<std::array<std::uint32_t, 256>, 4>;
constexpr ByteTables by_bytes(const Matrix& v) {
  ByteTables tables{};
  for (std::size_t byte = 0; byte < 4; ++byte) {
    for (std::size_t value = 1; value < 256; ++value) {
      const auto low = std::size_t(std::countr_zero(value));
      tables[byte][value] = tables[byte][value & (value - 1)] ^ v[8 * byte + low];
    }
  }
  return tables;
}
constexpr std::array<ByteTables, 4> tables = {by_bytes(matrices[0]), by_bytes(matrices[1]),
                                              by_bytes(matrices[2]), by_bytes(matrices[3])};

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x << 16U) | (x >> 16U);
  x = ((x & 0x00ff00ffU) << 8U) | ((x & 0xff00ff00U) >> 8U);
  x = ((x & 0x0f0f0f0fU) << 4U) | ((x & 0xf0f0f0f0U) >> 4U);
  x = ((x & 0x33333333U) << 2U) | ((x & 0xccccccccU) >> 2U);
  return ((x & 0x55555555U) << 1U) | ((x & 0xaaaaaaaaU) >> 1U);
}

// A full-avalanche 32-bit hash of a seed and a number (the finaliser "lowbias32", Wellons 2018).
constexpr std::uint32_t hash(std::uint32_t seed, std::uint32_t number) {
  std::uint32_t x = seed ^ (number * 0x9e3779b9U + 0x7f4a7c15U);
  for (int round = 0; round < 2; ++round) {
    x ^= x >> 16U;
    x *= 0x7feb352dU;
    x ^= x >> 15U;
    x *= 0x846ca68bU;
    x ^= x >> 16U;
  }
  return x;
}

}  // namespace

std::uint32_t sobol_bits(std::uint32_t index, std::uint32_t dimension) {
  const ByteTables& t = tables[dimension];
  return t[0][index & 255U] ^ t[1][(index >> 8U) & 255U] ^ t[2][(index >> 16U) & 255U] ^ t[3][index >> 24U];
}

// In reversed bits, multiplication, addition and x ^= x * even carry from low to high only: each bit
// depends on the bits below it, that is, on the more significant ones of the fraction.
std::uint32_t owen_scramble(std::uint32_t bits, std::uint32_t seed) {
  std::uint32_t x = reverse_bits(bits);
  x ^= x * 0x3d20adeaU;
  x += seed;
  x *= (seed >> 16U) | 1U;
  x ^= x * 0x05526c56U;
  x ^= x * 0x53a22864U;
  return reverse_bits(x);
}

// A nested permutation of the index takes 2^m aligned consecutive points to 2^m such points.
std::uint32_t sobol_index_in_block(std::uint32_t index, std::uint32_t block, std::uint32_t seed) {
  return block == 0 ? index : owen_scramble(index, hash(seed, 0x80000000U + block));
}

std::uint32_t scrambled_sobol_in_block(std::uint32_t index_in_block, std::uint32_t dimension,
                                       std::uint32_t seed) {
  return owen_scramble(sobol_bits(index_in_block, dimension % 4U), hash(seed, dimension));
}

std::uint32_t scrambled_sobol_bits(std::uint32_t index, std::uint32_t dimension, std::uint32_t seed) {
  return scrambled_sobol_in_block(sobol_index_in_block(index, dimension / 4U, seed), dimension, seed);
}

}  // namespace reflectree
