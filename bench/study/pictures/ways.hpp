// SPDX-License-Identifier: Apache-2.0
// The ways of reducing variance that exact sampling is combined with, in direct light alone, which admits all
// of them. Each follows as many of the material's own directions a pixel.
#pragma once

#include <span>

#include "measure.hpp"
#include "verdict.hpp"

namespace reflectree::pictures {

struct Way {
  const char* name;  // of the cells' method
  bool alone;        // one way, or several together
  render::PointSet::Kind points;
  render::Technique technique;
  int split;     // directions of each camera sample; where they are resampled, one of them is followed
  bool divided;  // drawn together, by division of the tree
};
// The first is plain: independent points, the material's own directions, no lights.
std::span<const Way> ways();

// `directions` a pixel are followed.
Method method_of(const Way& way, int directions);

// Gains over plain of one sampler: variance, and variance times CPU time, without the one pixel in a thousand
// whose error is largest; and variance with all of them.
struct Gain {
  Estimate variance, efficiency, untrimmed;
};
Gain gain_of(const Cells& plain, const Cells& way);

}  // namespace reflectree::pictures
