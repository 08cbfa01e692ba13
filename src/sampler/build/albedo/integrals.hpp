// SPDX-License-Identifier: Apache-2.0
// The albedo of single viewers, by adaptive cubature over the square of the domain.
#pragma once

#include <vector>

#include "build/field.hpp"

namespace reflectree::detail {

struct IntegralOptions {
  double relative_error = 2.5e-5;
  // Into how many cells half of the square is cut at first. Another cut is another cubature: what both agree
  // on is no accident of either.
  int cells_x = 8, cells_y = 4;
  bool rim = false;  // close in on the rim, where some functions bend within cos_theta_o of it
  float progress = 0, progress_end = 0;  // of the host's bar
  std::size_t max_regions = 40000;       // of one integral
};

struct Integrals {
  std::vector<double> values, errors;  // errors: relative; more than asked for where regions do not suffice
  double error = 0;                    // the largest
};

// Integrates T over the square for every viewer, in their frame; all integrals advance together,
// a batch per round.
Integrals integrate(const Field& field, const std::vector<Viewer>& viewers, const IntegralOptions& options,
                    const Host& host, Effort& effort);

}  // namespace reflectree::detail
