// SPDX-License-Identifier: Apache-2.0
#include "reflectree/peers/nmf.hpp"

#include <Eigen/Core>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

using Matrix = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr float tiny = 1e-30f;

Matrix product(const Matrix& a, const Matrix& b) { return (a.matrix() * b.matrix()).array(); }

}  // namespace

NonNegativeFactors factor_non_negative(std::span<const float> matrix, int rows, int columns, int terms,
                                       int iterations, std::uint64_t seed) {
  const Matrix y = Eigen::Map<const Matrix>(matrix.data(), rows, columns);
  Pcg32 bits(seed);
  const auto random = [&bits] { return 0.5f + to_unit_float(bits()); };
  // Each term starts near the best single one, the product of the sums of rows and columns.
  Matrix g = Matrix::NullaryExpr(rows, terms, random), h = Matrix::NullaryExpr(terms, columns, random);
  g.colwise() *= y.rowwise().sum() / float(terms);
  h.rowwise() *= y.colwise().sum() / std::max(y.sum(), tiny);
  for (int i = 0; i < iterations; ++i) {
    Matrix ratio = y / product(g, h).max(tiny);
    h *= product(g.transpose(), ratio).colwise() / g.colwise().sum().transpose().max(tiny);
    ratio = y / product(g, h).max(tiny);
    g *= product(ratio, h.transpose()).rowwise() / h.rowwise().sum().transpose().max(tiny);
  }
  const Eigen::ArrayXf mass = h.rowwise().sum();
  h.colwise() /= mass.max(tiny);
  g.rowwise() *= mass.transpose();
  return {terms, {g.data(), g.data() + g.size()}, {h.data(), h.data() + h.size()}};
}

}  // namespace reflectree
