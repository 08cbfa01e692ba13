// SPDX-License-Identifier: Apache-2.0
// How the three functions are meant, where the patient leaves that to be found out.
#pragma once

#include "functions.hpp"

namespace reflectree::detail {

struct Kinds {
  EvalKind eval = EvalKind::f;
  ValueKind value = ValueKind::weight;
  std::vector<std::string> sentences;
};
Kinds settle_kinds(const Patient& patient, std::uint64_t seed);

}  // namespace reflectree::detail
