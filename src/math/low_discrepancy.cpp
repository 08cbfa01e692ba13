// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/low_discrepancy.hpp"

#include <array>

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
  const Matrix& v = matrices[dimension];
  std::uint32_t x = 0;
  for (unsigned i = 0; index != 0; ++i, index >>= 1U) x ^= v[i] & (0U - (index & 1U));
  return x;
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

std::uint32_t scrambled_sobol_bits(std::uint32_t index, std::uint32_t dimension, std::uint32_t seed) {
  const std::uint32_t block = dimension / 4U;
  // A nested permutation of the index takes 2^m aligned consecutive points to 2^m such points.
  const std::uint32_t shuffled = block == 0 ? index : owen_scramble(index, hash(seed, 0x80000000U + block));
  return owen_scramble(sobol_bits(shuffled, dimension % 4U), hash(seed, dimension));
}

}  // namespace reflectree
