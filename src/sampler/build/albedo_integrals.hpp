// SPDX-License-Identifier: Apache-2.0
// The albedo at single elevations, by adaptive cubature over the square of the domain.
#pragma once

#include <vector>

#include "field.hpp"

namespace reflectree::detail {

struct IntegralOptions {
  double relative_error = 2.5e-5;
  // Into how many cells half of the square is cut at first. Another cut is another cubature: what both agree
  // on is no accident of either.
  int cells_x = 8, cells_y = 4;
  bool rim = false;  // close in on the rim, where some functions bend within cos_theta_o of it
  float progress = 0, progress_end = 0;  // of the host's bar
  float phi_o = 0;                       // of all viewers, in their frame
  Coordinates at = {};                   // of families
};

struct Integrals {
  std::vector<double> values;
  double error =
      0;  // the largest, relative; more than asked for where the limit of regions does not reach it
};

// Integrates T over the square for every cosine; all integrals advance together, a round a batch.
Integrals integrate(const Field& field, const std::vector<float>& cosines, const IntegralOptions& options,
                    const Host& host, Effort& effort);

}  // namespace reflectree::detail
