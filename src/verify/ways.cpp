// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/ways.hpp"

#include <algorithm>

namespace reflectree {

void TrialLog::add(const TrialLog& other) {
  for (std::size_t l = 0; l < lane.size(); ++l) {
    lane[l].trials += other.lane[l].trials;
    lane[l].accepted += other.lane[l].accepted;
    lane[l].expected += other.lane[l].expected;
    lane[l].variance += other.lane[l].variance;
    lane[l].together += other.lane[l].together;
    lane[l].together_variance += other.lane[l].together_variance;
  }
  sums.add(other.sums);
  exhausted += other.exhausted;
}

namespace detail {

void LaneWatcher::trial(bool accepted, float ratio, float majorant) {
  TrialLog::Lane& lane = log_.lane[next_];
  next_ += next_ < batch_lanes;
  const double r = majorant > 0 ? double(ratio) / double(majorant) : 0, p = std::clamp(r, 0., 1.);
  ++lane.trials;
  lane.accepted += accepted;
  lane.expected += p;
  lane.variance += p * (1 - p);
  const double miss = double(accepted) - p, variance = p * (1 - p);
  lane.together += miss * last_miss_;
  lane.together_variance += variance * last_variance_;
  last_miss_ = miss, last_variance_ = variance;
  log_.sums.add(r);
}

std::vector<Direction> strangers(std::size_t n, Pcg32& u) {
  std::vector<Direction> wos(n);
  for (Direction& w : wos) {
    const float theta = 1.02f * 0.5f * pi * to_unit_float(u());
    w = direction_from_angles(theta, 2 * pi * to_unit_float(u()));
  }
  return wos;
}

}  // namespace detail
template Suspect suspect(const Sampler<AnyBrdf>&, AnyBrdf, const SamplerData*);
template Suspect suspect(const Sampler<FamilyMember<AnyFamily>>&, AnyBrdf, const SamplerData*);

}  // namespace reflectree
