// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/erased.hpp"

#include "reflectree/verify/reference_target.hpp"

namespace reflectree {

TargetFunction target_function(AnyBrdf f, Target target) {
  TargetFunction result;
  result.concurrent = f.traits().concurrent;
  result.patches = f.traits().patches;
  result.eval = [f = std::move(f), target](Vec3<double> wo, std::span<const Vec3<double>> wi,
                                           std::span<double> t) {
    const auto channels = std::size_t(f.channels());
    std::vector<float> values(wi.size() * channels);
    channel_values(f, wo, wi, values);
    for (std::size_t i = 0; i < wi.size(); ++i) {
      t[i] = reference_target(target, std::span(values).subspan(i * channels, channels));
    }
  };
  return result;
}

}  // namespace reflectree
