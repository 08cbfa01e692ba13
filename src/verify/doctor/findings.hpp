// SPDX-License-Identifier: Apache-2.0
// The doctor's findings and checks, put into words.
#pragma once

#include "reflectree/verify/doctor.hpp"

namespace reflectree::detail {

Finding a_finding(const char* check, std::string cause, std::string words, Evidence evidence = {},
                  bool fault = true);
// A check whose statistic may not exceed its threshold.
CheckResult limited(const char* name, double statistic, double threshold, const std::string& detail,
                    const std::string& where = "");
std::string text(const char* format, double a, double b = 0, double c = 0);

}  // namespace reflectree::detail
