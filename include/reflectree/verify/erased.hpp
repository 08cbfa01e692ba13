// SPDX-License-Identifier: Apache-2.0
// What the checks look at, with the types erased, so that their work compiles once: the function as a
// target over double directions, and any sampler of directions.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/sampler/direction_sample.hpp"

namespace reflectree {

// t(wo, wi) in sr^-1, without cosine, for one wo and many wi; zero below the surface.
struct TargetFunction {
  std::function<void(Vec3<double> wo, std::span<const Vec3<double>> wi, std::span<double> t)> eval;
  bool concurrent = true;
  // Patches of wi over which t is constant, as f tells (BrdfTraits::patches): cubatures begin with them, and go
  // on halving where f is not what it told. Empty: none.
  std::vector<PatchBand> patches = {};
};

// By the referee's own definition of the target, in double (reference_target.hpp).
TargetFunction target_function(AnyBrdf f, Target target = {});

struct DrawnDirection {
  Direction wi;
  float pdf = 0;     // per solid angle
  float weight = 0;  // of the target: t cos_i / pdf
};

struct ErasedSampler {
  std::string name;
  std::function<bool(Direction wo, Pcg32& u, DrawnDirection& out)> sample;  // false: no sample
  std::function<float(Direction wo, Direction wi)> pdf;                     // empty: has no density
  bool concurrent = true;                                                   // false: called from one thread
};

// Borrows the sampler. Targets are homogeneous: the target of the weight is the weight of the target.
template <DirectionSampler S>
ErasedSampler erase(const S& sampler, Target target = {}, std::string name = "sampler") {
  ErasedSampler erased;
  erased.name = std::move(name);
  erased.sample = [&sampler, target](Direction wo, Pcg32& u, DrawnDirection& out) {
    const auto drawn = sampler.sample(wo, u);
    if (drawn) out = {drawn->wi, drawn->pdf, target(drawn->weight)};
    return drawn.has_value();
  };
  if constexpr (DensitySampler<S>) {
    erased.pdf = [&sampler](Direction wo, Direction wi) { return float(sampler.pdf(wo, wi)); };
  }
  return erased;
}

}  // namespace reflectree
