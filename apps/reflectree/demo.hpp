// SPDX-License-Identifier: Apache-2.0
// What demo finds about a material, and how it is shown.
#pragma once

#include <string>
#include <vector>

#include "measure.hpp"
#include "reflectree/brdf/material/registry.hpp"
#include "reflectree/draw/report.hpp"
#include "reflectree/verify/chi_square.hpp"

namespace reflectree::cli {

struct Outcome {
  std::string text, name, saved;  // as named, for a table and files, the sampler file
  draw::ReportMaterial report;
  Overshoot overshoot;
  Speed speed;
  std::vector<CheckResult> checks;
};

// The table and the page's path on stdout, or all of it as JSON.
void show_outcomes(const Context& context, const std::vector<Outcome>& outcomes, const std::string& page,
                   double seconds);

}  // namespace reflectree::cli
