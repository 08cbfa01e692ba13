// SPDX-License-Identifier: Apache-2.0
// Non-negative matrix factorisation: Y ~ left right with few terms and no negative entry, by the
// multiplicative updates of Lee and Seung 2000 ("Algorithms for Non-negative Matrix Factorization",
// theorem 2). They minimise the generalised Kullback-Leibler divergence, which to leading order is half the
// variance of the weight Y / Y' under the density Y'.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace reflectree {

struct NonNegativeFactors {
  int terms = 0;
  std::vector<float> left;   // [row][term]
  std::vector<float> right;  // [term][column], each term's entries sum to 1
};

// matrix[row * columns + column] >= 0.
NonNegativeFactors factor_non_negative(std::span<const float> matrix, int rows, int columns, int terms,
                                       int iterations = 300, std::uint64_t seed = 1);

}  // namespace reflectree
