// SPDX-License-Identifier: Apache-2.0
// Owen-scrambled Sobol' points with random access: point `index`, coordinate `dimension`, scramble
// `seed`, in any order, without state. Sobol' 1967 with the direction numbers of Joe & Kuo 2008;
// nested-uniform scrambling by hashing, Laine & Karras 2011, as improved by Burley 2020, "Practical
// Hash-based Owen Scrambling" (JCGT 9(4)) and Vegdahl 2021.
//
// 1. Dimensions come in blocks of four. Inside a block the points are a scrambled Sobol' sequence; the
//    blocks are padded: each visits its points in its own random nested order, which keeps prefixes.
// 2. Any 2^m consecutive points whose first index is a multiple of 2^m form a (0, m, 2)-net in
//    dimensions (4k, 4k + 1), and are stratified into 2^m intervals in every single dimension.
// 3. Each point is uniform in the unit cube over the seeds: estimates are unbiased.
#pragma once

#include <cstdint>

namespace reflectree {

// Coordinate of the unscrambled Sobol' sequence as a 32-bit fraction; dimension < 4.
std::uint32_t sobol_bits(std::uint32_t index, std::uint32_t dimension);

// A random permutation of the 32-bit fractions that keeps every dyadic interval together: bit i is
// flipped depending on the bits above it and the seed.
std::uint32_t owen_scramble(std::uint32_t bits, std::uint32_t seed);

// The scrambled coordinate as a 32-bit fraction, for any dimension.
std::uint32_t scrambled_sobol_bits(std::uint32_t index, std::uint32_t dimension, std::uint32_t seed);

// The same in two steps, where several coordinates of a block of four are wanted: the point of the sequence
// that the block visits, and its coordinate; dimension / 4 == block.
std::uint32_t sobol_index_in_block(std::uint32_t index, std::uint32_t block, std::uint32_t seed);
std::uint32_t scrambled_sobol_in_block(std::uint32_t index_in_block, std::uint32_t dimension,
                                       std::uint32_t seed);

// The same in [0, 1).
inline double scrambled_sobol(std::uint32_t index, std::uint32_t dimension, std::uint32_t seed) {
  return double(scrambled_sobol_bits(index, dimension, seed)) * 0x1p-32;
}

}  // namespace reflectree
