// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/result.hpp"

#include <algorithm>
#include <cstdio>

namespace reflectree {

std::string to_line(const CheckResult& r) {
  char numbers[128];
  std::snprintf(numbers, sizeof numbers, "%-18s %10.4g %s %-10.4g", r.name.c_str(), r.statistic,
                r.statistic <= r.threshold ? "<=" : "> ", r.threshold);
  std::string line = std::string(!r.passed ? "FAIL  " : r.decided ? "pass  " : "open  ") + numbers;
  if (r.p_value < 1) {
    std::snprintf(numbers, sizeof numbers, "  p = %.3g", r.p_value);
    line += numbers;
  }
  return r.detail.empty() ? line : line + "  (" + r.detail + ")";
}

bool all_passed(std::span<const CheckResult> results) {
  return std::all_of(results.begin(), results.end(), [](const CheckResult& r) { return r.passed; });
}

}  // namespace reflectree
