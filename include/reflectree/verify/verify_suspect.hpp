// SPDX-License-Identifier: Apache-2.0
// Every check of this room on one suspect: what verify.hpp calls with its templates.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "reflectree/host.hpp"
#include "reflectree/verify/result.hpp"
#include "reflectree/verify/suspect.hpp"

namespace reflectree {

struct VerifyFigure {
  std::string name, where;
  double value = 0;
};

struct VerifyReport {
  std::vector<CheckResult> checks;
  std::vector<VerifyFigure> figures;  // no verdicts: reciprocity, variance, ...
  std::vector<std::string> notes;     // what the build said about itself
  bool all_passed() const { return reflectree::all_passed(checks); }
};

struct VerifyOptions {
  double effort = 1;  // multiplies draws; 1 takes some 20 s of two cores where f is quick
  std::uint64_t seed = 1;
  double family_significance = 1e-5;
  std::vector<double> theta_o_deg{0, 30, 60, 80, 89};  // judged by chi-square, at random azimuths,
  int random_elevations = 3;                           // and so many more, anywhere
  std::uint64_t samples = 400'000;    // for each of them, by the first way of each mode; half by any other
  std::uint64_t trials = 10'000'000;  // in search of overshoots
  int albedo_directions = 80;         // compared with cubature: nodes, middles, anywhere
  int members = 3;                    // of a family: anywhere in its ranges, besides both ends
  // Called as results come.
  std::function<void(const CheckResult&)> on_check = [](const CheckResult&) {};
  std::function<void(const VerifyFigure&)> on_figure = [](const VerifyFigure&) {};
};

// Members of a family: both ends of its ranges, and so many anywhere.
std::vector<Parameters> members_to_verify(const std::vector<ParameterRange>& ranges, int anywhere,
                                          std::uint64_t seed);
// judge(member, options, host) of each of them; the effort is shared.
VerifyReport verify_members(
    const std::vector<ParameterRange>& ranges,
    const std::function<VerifyReport(const Parameters&, const VerifyOptions&, const Host&)>& judge,
    const VerifyOptions& options = {}, const Host& host = {});

// The judges. Ways and densities may be wrapped beforehand, to see a fault caught.
VerifyReport verify(const Suspect& suspect, const VerifyOptions& options = {}, const Host& host = {});

}  // namespace reflectree
