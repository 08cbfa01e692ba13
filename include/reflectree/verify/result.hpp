// SPDX-License-Identifier: Apache-2.0
// What every check of the verify room returns: a verdict that reads in one line and prints as JSON.
#pragma once

#include <span>
#include <string>

namespace reflectree {

// passed: statistic within threshold. What the two numbers are, `detail` says; p_value is 1 where the check
// is no statistical test.
struct CheckResult {
  std::string name;
  bool passed = false;
  double statistic = 0, threshold = 0;
  double p_value = 1;
  std::string detail;
};

// "pass  chi_square  412.3 <= 520.1  p = 0.34  (...)"
std::string to_line(const CheckResult& result);
bool all_passed(std::span<const CheckResult> results);

}  // namespace reflectree
