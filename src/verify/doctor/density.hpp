// SPDX-License-Identifier: Apache-2.0
// Do the directions follow pdf? And if not: what density do they follow?
#pragma once

#include <optional>

#include "examined.hpp"

namespace reflectree::detail {

// What is known of the true density of the directions.
struct DensityVerdict {
  bool judged = false;  // there is a pdf, and something was drawn
  bool holds = false;   // pdf fits
  bool explained = false;
  // Values of the true density at pairs where `holds` or `explained` by a formula; empty: unknown.
  std::function<std::vector<double>(std::span<const Direction> wo, std::span<const Direction> wi)> truth;
};

// Adds checks "pdf_integral" and "chi_square_pdf", and a finding where they fail. degenerate: the directions
// cannot fit any density, which has been told.
DensityVerdict judge_density(const Functions& f, std::span<const ExaminedView> views, double level,
                             bool degenerate, const Host& host, Diagnosis& diagnosis);

}  // namespace reflectree::detail
