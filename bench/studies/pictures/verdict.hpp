// SPDX-License-Identifier: Apache-2.0
// What the cells say: ratios with their standard errors over seeds, and the verdict against every rival.
#pragma once

#include "cells.hpp"

namespace reflectree::pictures {

// `error` is a standard error; NaN where there was one seed.
struct Estimate {
  double value = 0, error = 0;
};
Estimate mean_of(const std::vector<double>& x);
// Of numbers above zero; `error` is that of the mean.
Estimate geometric_mean_of(const std::vector<double>& x);
// Over seeds that both have: pairs share their camera rays.
using Cells = std::vector<const PictureCell*>;
Estimate ratio_at_time(const Cells& rival, const Cells& ours);
Estimate ratio_at_samples(const Cells& rival, const Cells& ours);
Estimate ratio_of_time(const Cells& rival, const Cells& ours);

enum class Half { reached, missed, out_of_reach };

// A rival's relMSE over ours in one scene by one method.
struct Against {
  std::string scene, method, rival;
  bool general = false;  // takes any BRDF
  Estimate one_shot, exact;
  Estimate samples;  // of the rival over one-shot mode at equal samples
  Estimate ideal;    // over exact mode at equal samples: what is left to gain for a sampler without noise of
                     // its own that costs no more than the rival
  Half half = Half::missed;
};
// Half of its error was asked for.
bool is_demanded(const Against& a);
// At least two standard errors below 1.
bool is_loss(const Estimate& ratio);

// Over the scenes of a method.
struct Mean {
  std::string method, rival;
  std::size_t scenes = 0;
  Estimate one_shot, exact;
};

struct Verdict {
  std::string ours;  // judged in one-shot mode's place
  std::vector<Against> against;
  std::vector<Mean> means;  // against general rivals
  // What was demanded: half of the cosine lobe's and of the fitted proxy's in every scene, and in geometric
  // mean no worse than any general sampler.
  bool half_everywhere = false, best_in_mean = false;
  // And what decision 0022 demands: half within anyone's reach, elsewhere no loss.
  bool half_within_reach = false;
};
bool demand_holds(const Verdict& v);  // decision 0022 and the means; rivals that are not there are not missed
Verdict judge(const Results& results, const std::vector<std::string>& methods, const std::string& ours);

}  // namespace reflectree::pictures
