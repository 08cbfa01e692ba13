// SPDX-License-Identifier: Apache-2.0
// Stand-ins for measured materials where none are at hand: small tables computed from formulas, with what
// real measurements have: noise from cell to cell, a slight drift, and no reciprocity.
#pragma once

#include <span>
#include <string_view>

#include "reflectree/brdf/tables/half_angle_table.hpp"

namespace reflectree {

struct BakedTable {
  std::string_view name, summary;
};
// baked_matt, baked_glossy, baked_retro.
std::span<const BakedTable> baked_tables();

// Computes a table by its name: the same values every time. Throws Error for another name.
HalfAngleTable bake_table(std::string_view name);

}  // namespace reflectree
