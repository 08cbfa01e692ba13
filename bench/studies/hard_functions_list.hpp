// SPDX-License-Identifier: Apache-2.0
// Functions that somebody may bring and that tempt a builder to be wrong: needles, rings, steps, extremes of
// scale, odd values, bad manners. Each stands for a kind.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/sampler/build.hpp"

namespace reflectree::study {

struct HardFunction {
  std::string name, what;
  std::function<AnyBrdf()> make;  // may throw, as building may
  bool refused = false;           // no sampler can be right: a sentence is expected
  bool may_be_refused = false;    // right, or a sentence
  // Where the judge's chart is to look closest, for wo at azimuth 0; default: where a search finds f highest.
  std::function<Direction(Direction wo)> centre = {};
};

std::vector<HardFunction> hard_functions();

}  // namespace reflectree::study
