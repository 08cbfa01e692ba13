// SPDX-License-Identifier: Apache-2.0
// The material parameters of a family (family.hpp): their ranges and values.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace reflectree {

inline constexpr std::size_t max_parameters = 2;
// Values in the order of the family's ranges; those beyond them are 0.
using Parameters = std::array<float, max_parameters>;

// Both borders belong to it.
struct ParameterRange {
  std::string name;
  float lo = 0, hi = 1;
  bool contains(float value) const { return value >= lo && value <= hi; }
  friend bool operator==(const ParameterRange&, const ParameterRange&) = default;
};

// Throws Error unless there are one or two ranges with names of their own, none of them empty.
void check_ranges(const std::vector<ParameterRange>& ranges, const std::string& name);
// "alpha = 0.3", for errors and figures.
std::string to_text(const std::vector<ParameterRange>& ranges, const Parameters& at);

// Whether F is a family at fixed parameters.
template <class F>
inline constexpr bool is_member_v = false;

}  // namespace reflectree
