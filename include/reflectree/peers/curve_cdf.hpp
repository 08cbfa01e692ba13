// SPDX-License-Identifier: Apache-2.0
// Adaptive numerical CDFs. Lawrence, Rusinkiewicz and Ramamoorthi 2005, "Adaptive Numerical Cumulative
// Distribution Functions for Efficient Importance Sampling": the cumulative function of the marginal, then
// one conditional function for each of its intervals, each a polyline through as few of its points as keep it
// within a tolerance.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reflectree/math/direction.hpp"
#include "reflectree/math/uniform_bits.hpp"

namespace reflectree {

struct CurveOptions {
  float marginal_tolerance = 1e-3f, conditional_tolerance = 4e-3f;  // of the cumulative functions
};

// A polyline from (0, 0) to (1, 1); its slope is a piecewise constant density.
struct CurvePoint {
  float x, cdf;
};
// Greedy: the worst point of the finely sampled curve `cdf` (values at i / (size - 1)) is added until none is
// off by more than the tolerance.
std::vector<CurvePoint> reduce_curve(std::span<const double> cdf, float tolerance);

class CurveCdf {
 public:
  // cells[y * width + x] >= 0: means over equal cells of the square. x is the marginal's variable.
  CurveCdf(std::span<const float> cells, int width, int height, const CurveOptions& options = {});

  Vec2<float> sample(UniformBits& u) const;
  float pdf(Vec2<float> p) const;
  std::size_t bytes() const;

 private:
  std::span<const CurvePoint> conditional(std::size_t interval) const;

  std::vector<CurvePoint> marginal_;
  std::vector<CurvePoint> conditionals_;
  std::vector<std::uint32_t> first_;  // [interval of the marginal], and the end
};

}  // namespace reflectree
