// SPDX-License-Identifier: Apache-2.0
// Here once: every way into a sampler takes long to compile.
#include "suspects.hpp"

#include "reflectree/verify/ways.hpp"

namespace reflectree {

Suspect suspect_of(const Sampler<Plastic>& sampler, const SamplerData* data) {
  return suspect(sampler, AnyBrdf(coloured()), data);
}
Suspect Built::suspect() const { return suspect_of(sampler, &data); }

const Built& built() {
  static const Built b = [] {
    SamplerData data = build(AnyBrdf(coloured()));
    Sampler<Plastic> sampler = make_sampler(coloured(), data);
    return Built{std::move(data), std::move(sampler)};
  }();
  return b;
}

Sampler<Plastic> sampler_of(PackedSampler packed) {
  const auto shared = std::make_shared<const PackedSampler>(std::move(packed));
  return {ExactSampler<Plastic>(coloured(), shared), OneShotSampler<Plastic>(coloured(), shared)};
}

}  // namespace reflectree
