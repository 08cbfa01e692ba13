// SPDX-License-Identifier: Apache-2.0
#include "findings.hpp"

#include <cstdio>

namespace reflectree::detail {

Finding a_finding(const char* check, std::string cause, std::string words, Evidence evidence, bool fault) {
  Finding finding;
  finding.check = check;
  finding.cause = std::move(cause);
  finding.words = std::move(words);
  finding.evidence = std::move(evidence);
  finding.fault = fault;
  return finding;
}

CheckResult limited(const char* name, double statistic, double threshold, const std::string& detail,
                    const std::string& where) {
  CheckResult r;
  r.name = name;
  r.statistic = statistic;
  r.threshold = threshold;
  r.passed = statistic <= threshold;
  r.detail = detail;
  r.where = where;
  return r;
}

std::string text(const char* format, double a, double b, double c) {
  char buffer[240];
  std::snprintf(buffer, sizeof buffer, format, a, b, c);
  return buffer;
}

}  // namespace reflectree::detail
