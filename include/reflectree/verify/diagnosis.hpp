// SPDX-License-Identifier: Apache-2.0
// What the doctor says: findings with a cause in words, its figures and a pair of directions that shows it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "reflectree/verify/bins.hpp"
#include "reflectree/verify/result.hpp"
#include "reflectree/verify/verify_suspect.hpp"

namespace reflectree {

// One pair at which the fault shows, as simple as was found.
struct Evidence {
  Direction wo{}, wi{};
  std::string quantity;  // "pdf(wo, wi)"; empty: no pair
  double found = 0, expected = 0;
};

struct Finding {
  std::string check;  // which saw it: "chi_square_pdf"
  // The hypothesis that explains the data to within statistics, a key for programs: "pdf_swapped"; or
  // "unexplained". doctor_causes() has them all.
  std::string cause;
  std::string words;  // a sentence
  Evidence evidence = {};
  std::vector<VerifyFigure> figures = {};  // what the check measured
  bool fault = true;                       // false: a remark that fails nobody, such as missing reciprocity
};

// One viewer: bins of nearly equal probability, what fell into them and what should have.
struct DoctorView {
  Direction wo{};
  Bins bins{wo, HemisphereChart({0, 0, 1}), {}, {}, {}, 0, 0};
  std::vector<double> count = {};     // directions drawn, per bin
  std::vector<double> pdf_mass = {};  // integral of pdf over each bin; empty without pdf
  std::vector<double> f_mass = {};    // integral of the target times cos_theta_i
  double draws = 0, lost = 0;         // all draws; those without a direction above the surface
};

struct Diagnosis {
  std::string subject;
  std::vector<std::string> conventions;  // how the three functions were understood, in sentences
  std::vector<CheckResult> checks;
  std::vector<Finding> findings;
  std::vector<VerifyFigure> figures;  // quality, no verdicts: relative variance, worst weight, ...
  std::vector<DoctorView> views;
  // No fault was found.
  bool healthy() const;
};

struct DoctorCause {
  std::string_view key, meaning;
};
std::span<const DoctorCause> doctor_causes();

// The finding's sentence with its evidence and figures, over a few lines.
std::string to_text(const Finding& finding);

}  // namespace reflectree
