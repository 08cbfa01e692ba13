// SPDX-License-Identifier: Apache-2.0
// Adaptive cubature over a rectangle with an error bound: Genz & Malik 1980/1983 (17 points, degree 7
// with an embedded degree 5), regions of largest error halved first, along the axis of the larger fourth
// difference. The integrand is evaluated in large batches, as an erased reflectance function likes it.
// Rejected: tensor Gauss-Kronrod (misjudges peaks, 225 points), libcubature (GPL).
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "reflectree/math/direction.hpp"

namespace reflectree {

struct CubatureBox {
  double x0 = 0, x1 = 1, y0 = 0, y1 = 1;
  friend bool operator==(const CubatureBox&, const CubatureBox&) = default;
};

// out[i] = integrand at points[i]; called from the calling thread.
using Integrand = std::function<void(std::span<const Vec2<double>> points, std::span<double> out)>;

struct CubatureOptions {
  double relative_tolerance = 1e-6;
  double absolute_tolerance = 0;
  std::size_t max_evaluations = 4'000'000;
  // Equal cells to start from: a needle narrower than about a tenth of a cell can be missed.
  int cells_x = 4, cells_y = 4;
};

// error: estimated bound on |value - integral|; generous where f is smooth (median 100 times too large),
// right in 19 of 20 cases for kinks and jumps along arbitrary lines. converged: error <= the larger
// tolerance. A value that is not finite ends the work with error = infinity.
struct CubatureResult {
  double value = 0, error = 0;
  std::size_t evaluations = 0;
  bool converged = false;
};
CubatureResult cubature(const Integrand& f, const CubatureBox& domain, const CubatureOptions& options = {});

// The same, with the regions it ended with: they tile the domain, `value` sums to the integral.
struct CubatureRegion {
  CubatureBox box;
  double value = 0, error = 0;
};
CubatureResult cubature(const Integrand& f, const CubatureBox& domain, const CubatureOptions& options,
                        std::vector<CubatureRegion>& regions);

}  // namespace reflectree
