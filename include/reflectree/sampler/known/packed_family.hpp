// SPDX-License-Identifier: Apache-2.0
// The parameters of a family and the law of its widths as every sample reads them: without a call.
#pragma once

#include "reflectree/math/fast_functions.hpp"
#include "reflectree/sampler/known/parameter.hpp"

namespace reflectree {

struct PackedParameter {
  float lo = 0, hi = 0;           // both belong to the range
  float lowest = 0, highest = 0;  // their coordinates
  bool logarithmic = false;
};

// largest exp(slope . (at - corner)) with the corner where the width is largest: no exponent is above 0.
struct PackedWidth {
  float largest = 1;
  Coordinates slope{}, corner{};
  float at(const Coordinates& at) const {
    return largest * exp_of_negative(slope[0] * (at[0] - corner[0]) + slope[1] * (at[1] - corner[1]));
  }
};

struct PackedFamily {
  std::size_t count = 0;  // of parameters; 0: of no family
  std::array<PackedParameter, max_parameters> parameters{};
  PackedWidth x, y;   // the domain's
  bool round = true;  // both are the same
};
PackedFamily pack(const std::vector<KnownParameter>& parameters, const ScaleLaw& law);

// The coordinates of parameters; false where one is outside of its range, or not finite.
inline bool find_coordinates(const PackedFamily& family, const Parameters& values, Coordinates& at) {
  at = {};
  for (std::size_t i = 0; i < family.count; ++i) {
    const PackedParameter& p = family.parameters[i];
    if (!(values[i] >= p.lo && values[i] <= p.hi)) return false;
    at[i] = clamp(p.logarithmic ? log_of_positive(values[i]) : values[i], p.lowest, p.highest);
  }
  return true;
}

}  // namespace reflectree
