// SPDX-License-Identifier: Apache-2.0
// What was promised of anisotropic materials, judged material by material.
#pragma once

#include "measurement.hpp"

namespace reflectree::study {

// What a material does not keep, in words; empty: all is kept.
std::vector<std::string> misses_of(const Measurement& m, const StudyOptions& options);

// The results as a page of Markdown.
std::string anisotropic_page(const std::vector<Measurement>& all, const StudyOptions& options,
                             const std::string& command);

}  // namespace reflectree::study
