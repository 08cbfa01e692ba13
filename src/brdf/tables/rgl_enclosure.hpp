// SPDX-License-Identifier: Apache-2.0
// RGL tables over boxes of directions: the formula of rgl_table.hpp and rgl_wide_table.hpp, step by step, over forms.
#pragma once

#include "reflectree/brdf/enclosure.hpp"

namespace reflectree {

class RglTable;
class RglWideTable;

std::shared_ptr<const BrdfEnclosure> enclosure_of(const RglTable& table);
std::shared_ptr<const BrdfEnclosure> enclosure_of(const RglWideTable& table);

}  // namespace reflectree
