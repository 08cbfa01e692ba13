// SPDX-License-Identifier: Apache-2.0
// What may have gone wrong, as transformations: the true density is pdf(turn(wo, wi)) * factor(wo, wi). Each
// is the undoing of one mistake, so the one that makes the data fit names the mistake.
#pragma once

#include <span>
#include <string>

#include "functions.hpp"

namespace reflectree::detail {

struct DirectionPair {
  Vec3<double> wo, wi;
};

struct DensityHypothesis {
  const char* cause;
  const char* words;                       // about pdf; with turned directions, about pdf and sample
  DirectionPair (*turn)(DirectionPair);    // nullptr: none
  double (*factor)(const DirectionPair&);  // nullptr: 1
};

// Simplest and most usual first.
std::span<const DensityHypothesis> density_hypotheses();

// The same for a weight: weight * pdf = f cos_theta_i * factor(wo, wi, pdf).
struct WeightHypothesis {
  const char* cause;
  const char* words;
  double (*factor)(const DirectionPair&, double pdf);
};
std::span<const WeightHypothesis> weight_hypotheses();

// A factor that has a name, such as 1/(2 pi); empty where it has none. Within `tolerance`, relative.
std::string name_of_factor(double factor, double tolerance);

}  // namespace reflectree::detail
