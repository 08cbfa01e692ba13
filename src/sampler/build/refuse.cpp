// SPDX-License-Identifier: Apache-2.0
#include "refuse.hpp"

#include <cmath>
#include <cstdio>

#include "reflectree/error.hpp"

namespace reflectree::detail {

std::string describe(Direction wo, Direction wi) {
  char text[192];
  std::snprintf(text, sizeof text, "wo = (%.7g, %.7g, %.7g), wi = (%.7g, %.7g, %.7g)", double(wo.x),
                double(wo.y), double(wo.z), double(wi.x), double(wi.y), double(wi.z));
  return text;
}

void refuse_values(std::span<const float> values, const std::string& name, Direction wo, Direction wi) {
  std::string list;
  bool negative = false, finite = true;
  for (std::size_t c = 0; c < values.size(); ++c) {
    negative = negative || values[c] < 0;
    finite = finite && std::isfinite(values[c]);
    if (c == 8) list += ", ...";
    if (c >= 8) continue;
    char text[32];
    std::snprintf(text, sizeof text, "%s%.6g", c > 0 ? ", " : "", double(values[c]));
    list += text;
  }
  const std::string where = name + " at " + describe(wo, wi);
  if (finite && negative) {
    throw Error("the BRDF returned [" + list + "], which is negative", where,
                "return no less than 0 there; if rounding did it, clamp the value at 0");
  }
  if (finite) {
    throw Error("the BRDF returned [" + list + "], whose target leaves the range of float", where,
                "divide the function by a constant and multiply the weights by it");
  }
  throw Error("the BRDF returned [" + list + "]: it must be finite and not negative", where,
              "mend the function at these directions");
}

}  // namespace reflectree::detail
