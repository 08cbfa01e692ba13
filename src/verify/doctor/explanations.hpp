// SPDX-License-Identifier: Apache-2.0
// Which density explains the directions that pdf does not: named transformations first, then families with a
// parameter that is fitted. An explanation must fit at every viewer.
#pragma once

#include "density.hpp"

namespace reflectree::detail {

struct Explanation {
  std::string cause, words;  // empty: none
  std::function<std::vector<double>(std::span<const Direction> wo, std::span<const Direction> wi)> truth;
};

Explanation explain_density(const Functions& f, std::span<const ExaminedView> views, bool shape_holds,
                            double level, const Host& host);

}  // namespace reflectree::detail
