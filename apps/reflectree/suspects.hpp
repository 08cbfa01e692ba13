// SPDX-License-Identifier: Apache-2.0
// The faults that verify can plant in what it looks at.
#pragma once

#include "reflectree/verify/ways.hpp"
#include "subject.hpp"

namespace reflectree::cli {

// "none" first.
const std::vector<std::string>& fault_names();
std::string fault_list();

// The subject with a fault in its data ("halved-bound"); untouched for any other.
OpenedSampler with_fault(const std::string& fault, OpenedSampler subject);

// Borrows the subject. Any other fault is planted in every way into the sampler.
Suspect suspect_with_fault(const OpenedSampler& subject, const std::string& fault);

// A family, its data with the fault where it is one of data.
OpenedFamily with_fault(const std::string& fault, OpenedFamily subject);
// One of its members. Borrows both.
using MemberSampler = Sampler<FamilyMember<AnyFamily>>;
Suspect suspect_with_fault(const OpenedFamily& subject, const Parameters& at, const MemberSampler& member,
                           const std::string& fault);

}  // namespace reflectree::cli
