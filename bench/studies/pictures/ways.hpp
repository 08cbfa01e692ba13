// SPDX-License-Identifier: Apache-2.0
// The ways of reducing variance that exact sampling is combined with, in direct light alone, which admits all
// of them. Each follows as many of the material's own directions per pixel.
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

// Monotone one-shot mode differs where points are more than random alone.
bool is_shown(const Way& way, std::string_view sampler);

// `directions` per pixel are followed.
Method method_of(const Way& way, int directions);

// Gains over plain of one sampler: variance, variance times CPU time, and variance without the one pixel in a
// thousand whose error is largest.
struct Gain {
  Estimate variance, efficiency, trimmed;
};
Gain gain_of(const Cells& plain, const Cells& way);

}  // namespace reflectree::pictures
