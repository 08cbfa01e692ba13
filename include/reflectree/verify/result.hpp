// SPDX-License-Identifier: Apache-2.0
// What every check of the verify room returns: a verdict that reads in one line and prints as JSON.
#pragma once

#include <span>
#include <string>

namespace reflectree {

// passed: statistic within threshold. What the two numbers are, `detail` says; p_value is 1 where the check
// is no statistical test. A check that cannot be told from what was drawn fails nobody: passed, not decided,
// and `detail` says what would decide it.
struct CheckResult {
  std::string name;
  bool passed = false;
  double statistic = 0, threshold = 0;
  double p_value = 1;
  std::string detail = {};
  bool decided = true;
  std::string where = {};  // the directions it was about
  std::string way = {};    // the way into the sampler, where it is about one
};

// "pass  chi_square  412.3 <= 520.1  p = 0.34  (...)"; "open" where it is not decided.
std::string to_line(const CheckResult& result);
// Nothing failed.
bool all_passed(std::span<const CheckResult> results);

}  // namespace reflectree
