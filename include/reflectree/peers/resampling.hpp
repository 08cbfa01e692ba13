// SPDX-License-Identifier: Apache-2.0
// Sampling importance resampling: of a few candidates from a mixture one is kept in proportion to T / p.
// Talbot, Cline and Egbert 2005. Its density is not known; the weight f_cos / T * mean(T / p) is unbiased
// (eq. 5 there).
#pragma once

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/peers/lobe.hpp"

namespace reflectree {

struct ResamplingSampler {
  using Value = Spectrum;
  AnyBrdf f;
  Target target;
  LobeMixture candidates;
  int count = 8;

  // The sample's pdf is 0: unknown.
  template <RandomBits U>
  std::optional<DirectionSample<Value>> sample(Direction wo, U& u) const {
    if (!(wo.z > 0)) return std::nullopt;
    UniformBits bits(Pcg32((std::uint64_t(u()) << 32U) | u(), u()));
    Direction kept{};
    Value kept_f(f.channels());
    double sum = 0, kept_t = 0;
    for (int i = 0; i < count; ++i) {
      const auto drawn = candidates.sample(wo, bits);
      if (!drawn || !(drawn->pdf > 0)) continue;  // a lost candidate counts as one of weight zero
      const Value value = eval(f, wo, drawn->wi);
      const double t = double(target(value)) * double(drawn->wi.z), w = t / double(drawn->pdf);
      sum += w;
      if (w > 0 && to_unit_double(bits()) * sum < w) kept = drawn->wi, kept_f = value, kept_t = t;
    }
    if (!(kept_t > 0)) return std::nullopt;
    const double scale = double(kept.z) / kept_t * sum / count;
    return DirectionSample<Value>{kept, 0, scaled_value(kept_f, float(scale))};
  }
};

}  // namespace reflectree
