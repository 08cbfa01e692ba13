// SPDX-License-Identifier: Apache-2.0
// Values by themselves: finite, not negative, the same when asked again; what f says of physics; and how the
// three functions are meant, where the patient leaves that to be found out.
#pragma once

#include "doctor_examined.hpp"

namespace reflectree::detail {

struct Kinds {
  EvalKind eval = EvalKind::f;
  ValueKind value = ValueKind::weight;
  std::vector<std::string> sentences;
};
Kinds settle_kinds(const Patient& patient, std::uint64_t seed);

void check_values(const Functions& f, std::uint64_t seed, Diagnosis& diagnosis);
void check_repeatable(const Functions& f, std::uint64_t seed, Diagnosis& diagnosis);
void remark_on_physics(const Functions& f, std::span<const ExaminedView> views, std::uint64_t seed,
                       Diagnosis& diagnosis);

Finding a_finding(const char* check, std::string cause, std::string words, Evidence evidence = {},
                  bool fault = true);
// A check whose statistic may not exceed its threshold.
CheckResult limited(const char* name, double statistic, double threshold, const std::string& detail,
                    const std::string& where = "");

}  // namespace reflectree::detail
