// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/parameter.hpp"

#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree {

void check_ranges(const std::vector<ParameterRange>& ranges, const std::string& name) {
  if (ranges.empty() || ranges.size() > max_parameters) {
    throw Error("the family has " + std::to_string(ranges.size()) + " parameters with a range", name,
                "give it one or two");
  }
  for (const ParameterRange& r : ranges) {
    if (!(std::isfinite(r.lo) && std::isfinite(r.hi) && r.lo < r.hi)) {
      const bool finite = std::isfinite(r.lo) && std::isfinite(r.hi);
      const std::string from =
          finite ? "from " + shortest_text(r.lo) + " to " + shortest_text(r.hi) : std::string("not finite");
      throw Error("the range of " + r.name + " is " + from, name, "give the smaller number first");
    }
  }
  if (ranges.size() > 1 && ranges[0].name == ranges[1].name)
    throw Error("two ranges are both named " + ranges[0].name, name, "give them names of their own");
}

std::string to_text(const std::vector<ParameterRange>& ranges, const Parameters& at) {
  std::string text;
  for (std::size_t i = 0; i < ranges.size() && i < at.size(); ++i) {
    text += (text.empty() ? "" : ", ") + ranges[i].name + " = " +
            (std::isfinite(at[i]) ? shortest_text(at[i]) : std::string("not finite"));
  }
  return text;
}

}  // namespace reflectree
