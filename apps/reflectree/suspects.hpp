// SPDX-License-Identifier: Apache-2.0
// What verify looks at: a subject's two modes and its function; and the faults that it can plant there.
#pragma once

#include "reflectree/verify/erased.hpp"
#include "subject.hpp"

namespace reflectree::cli {

// "none" first.
const std::vector<std::string>& fault_names();
std::string fault_list();

// The subject with a fault in its data ("halved-bound"); untouched for any other.
Subject with_fault(const std::string& fault, Subject subject);

struct Suspects {
  ErasedSampler exact, one_shot;
  TargetFunction f;
};
// Borrows the subject. Faults of sampling are planted about wo.
Suspects suspects(const Subject& subject, const std::string& fault, Direction wo);

}  // namespace reflectree::cli
