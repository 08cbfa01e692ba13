// SPDX-License-Identifier: Apache-2.0
// A diagnosis as one offline page.
#pragma once

#include <string>

#include "reflectree/study/report.hpp"
#include "reflectree/verify/diagnosis.hpp"

namespace reflectree::study {

std::string doctor_html(const Diagnosis& diagnosis, const StudyMeta& meta);

}  // namespace reflectree::study
