// SPDX-License-Identifier: Apache-2.0
// What eval and pdf say at each draw, as ranges: of the direction and of its neighbours in float.
#pragma once

#include "density.hpp"
#include "hypotheses.hpp"
#include "neighbours.hpp"

namespace reflectree::detail {

using Values = std::vector<double>;
using Ranges = std::vector<Range>;

inline constexpr double dim = 1e-5;  // of the brightest channel: what a dim one may be off

double relative_error(const Range& r, double x);

class AroundDraws {
 public:
  AroundDraws(const Functions& f, const Pointwise& draws);

  DirectionPair pair(std::size_t i) const;
  Ranges pdf_ranges(const DensityHypothesis* h = nullptr, bool inverse = false) const;
  Ranges truth_ranges(const DensityVerdict& density) const;
  // value -> f cos_theta_i as the draw has it: weight times the density in use.
  Values claimed(const Values& density) const;
  // Share of draws whose channels all agree with f cos_theta_i times a factor; `from` permutes channels.
  double weight_share(const Values& claimed, const Values& factor, const std::vector<std::size_t>& from,
                      const Ranges& f_cos, double tolerance, std::size_t* worst = nullptr) const;
  // f there, the cosine of the draw.
  Ranges f_cos_at(const Directions& wo, const Directions& wi) const;

  const Functions& f;
  const Pointwise& draws;
  std::size_t channels;
  Directions wo, wi;  // the neighbours of every draw, one draw after the other
  Ranges f_cos;
};

// The share of values that lie in their range, up to a relative tolerance.
double share(const Ranges& r, const Values& x, double tolerance);

}  // namespace reflectree::detail
