// SPDX-License-Identifier: Apache-2.0
// Who wins. A sampler's efficiency on a material is the geometric mean over theta_o and lights of
// 1 / (RMSE^2 * time), time in units of a polar cosine-hemisphere sample of the same run.
#pragma once

#include "reflectree/study/measure.hpp"

namespace reflectree::study {

struct Score {
  std::string sampler;
  bool ours = false, general = false;
  int materials = 0, biased_cells = 0, faults = 0;
  // Geometric mean, over the materials that it serves, of its efficiency over that of the better of our modes.
  double relative_efficiency = 0;
};

struct Loss {
  std::string material, winner;
  double ratio = 0;  // our efficiency / the winner's, < 1
  // Where it loses most, and why: both ratios winner / ours at that cell, RMSE^2 and time.
  double theta_o_deg = 0;
  std::string light;
  double error_ratio = 0, time_ratio = 0;
};

// In a few words: does the winner vary less, is it quicker, or both?
std::string cause_of(const Loss& loss);

struct Verdict {
  int materials = 0, won = 0;  // where ours and a general competitor were measured
  std::vector<Score> scores;   // as in the registry
  std::vector<Loss> losses;    // the worst first
  bool best_in_mean = false, nine_in_ten = false;
};

// Of cells without efficiency (no error measured, no time), 0.
double efficiency(const SamplerResult& sampler);
Verdict judge(std::span<const MaterialResult> materials, std::span<const SamplerInfo> samplers,
              std::span<const Illumination> lights, const StudyOptions& options);

}  // namespace reflectree::study
