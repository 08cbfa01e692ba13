// SPDX-License-Identifier: Apache-2.0
// A material parameter of a family as a known coordinate.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "reflectree/brdf/parameter.hpp"
#include "reflectree/math/scalar.hpp"

namespace reflectree {

// Slabs and tables divide a parameter evenly; where its range spans a factor of 4 or more, its logarithm.
struct KnownParameter {
  ParameterRange range;
  bool logarithmic = false;
  friend bool operator==(const KnownParameter&, const KnownParameter&) = default;
};
inline bool is_logarithmic(const ParameterRange& range) { return range.lo > 0 && range.hi >= 4 * range.lo; }

// The values of all parameters as coordinates; those that are not there are 0.
using Coordinates = std::array<float, max_parameters>;

inline float lowest(const KnownParameter& p) { return p.logarithmic ? std::log(p.range.lo) : p.range.lo; }
inline float highest(const KnownParameter& p) { return p.logarithmic ? std::log(p.range.hi) : p.range.hi; }

inline float coordinate_of(const KnownParameter& p, float value) {
  return p.logarithmic ? std::log(value) : value;
}
// Inside of the range, whatever the rounding.
inline float value_of(const KnownParameter& p, float coordinate) {
  return clamp(p.logarithmic ? std::exp(coordinate) : coordinate, p.range.lo, p.range.hi);
}
inline Parameters values_of(const std::vector<KnownParameter>& parameters, const Coordinates& at) {
  Parameters values{};
  for (std::size_t i = 0; i < parameters.size(); ++i) values[i] = value_of(parameters[i], at[i]);
  return values;
}

// How the lobes of a family widen with its parameters: the logarithms of the widths along both axes, linear
// in the coordinates.
struct ScaleLaw {
  std::array<float, 1 + max_parameters> x{}, y{};
  friend bool operator==(const ScaleLaw&, const ScaleLaw&) = default;
};
inline float scale_by(const std::array<float, 1 + max_parameters>& law, const Coordinates& at) {
  return std::exp(law[0] + law[1] * at[0] + law[2] * at[1]);
}

}  // namespace reflectree
