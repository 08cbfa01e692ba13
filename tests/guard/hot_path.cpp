// SPDX-License-Identifier: Apache-2.0
// Compiled with -fno-exceptions -fno-rtti: drawing directions needs neither.
#include "reflectree/sampler/exact_sampler.hpp"
#include "reflectree/sampler/one_shot_sampler.hpp"

namespace reflectree {

inline constexpr auto lambda = [](Direction, Direction) { return 0.5f / pi; };
using Lambda = std::remove_const_t<decltype(lambda)>;
static_assert(DensitySampler<ExactSampler<Lambda>> && DensitySampler<OneShotSampler<Lambda>>);
template class ExactSampler<Lambda>;
template class OneShotSampler<Lambda>;

float draw(const ExactSampler<Lambda>& exact, const OneShotSampler<Lambda>& one_shot, Direction wo,
           Pcg32& random) {
  SampleStatistics statistics;
  const auto a = exact.sample(wo, random, statistics);
  const auto b = exact.sample_once(wo, random);
  const auto c = one_shot.sample(wo, random);
  const auto d = one_shot.sample(wo, 0.25, 0.75);
  return (a ? a->weight : 0.f) + (b ? b->weight : 0.f) + (c ? c->pdf : 0.f) + (d ? d->pdf : 0.f);
}

}  // namespace reflectree
