// SPDX-License-Identifier: Apache-2.0
// The integral of t cos_i over each bin, for a function that need not be the one that the bins were made for.
#pragma once

#include "reflectree/verify/bins.hpp"

namespace reflectree {

struct BinMasses {
  std::vector<double> mass;
  double error = 0;  // sum of the estimated errors
};
BinMasses function_masses(const TargetFunction& f, const Bins& bins, double tolerance = 1e-3,
                          const Host& host = {});

}  // namespace reflectree
