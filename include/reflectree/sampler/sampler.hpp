// SPDX-License-Identifier: Apache-2.0
// A sampler of one BRDF: both modes over shared, immutable data. Threads share it; random bits are passed in.
//
//   auto sampler = reflectree::make_sampler(reflectree::Ggx{0.1f});
//   auto s = sampler.exact.sample(wo, random);      // density exactly proportional to t cos_i
//   auto q = sampler.one_shot.sample(wo, u1, u2);   // two uniforms, no rejection
#pragma once

#include "reflectree/sampler/build.hpp"
#include "reflectree/sampler/exact_sampler.hpp"
#include "reflectree/sampler/identity.hpp"
#include "reflectree/sampler/one_shot_sampler.hpp"

namespace reflectree {

template <Brdf F>
struct Sampler {
  ExactSampler<F> exact;
  OneShotSampler<F> one_shot;
};

// From canonical data built for f; throws Error if it was built for another BRDF.
template <Brdf F>
Sampler<F> make_sampler(F f, const SamplerData& data) {
  check_identity(data, AnyBrdf(f));
  auto packed = std::make_shared<const PackedSampler>(pack(data));
  return {ExactSampler<F>(f, packed), OneShotSampler<F>(f, packed)};
}

// Builds it.
template <Brdf F>
Sampler<F> make_sampler(F f, const BuildOptions& options = {}, const Host& host = {}) {
  return make_sampler(f, build(AnyBrdf(f), options, host));
}

// Of what is no BRDF: one readable line instead of a page of constraints.
template <class F, class... Options>
requires(!Brdf<F> && !is_family_v<F>) void make_sampler(const F&, const Options&...) {
  static_assert(std::is_void_v<F>,
                "a BRDF is called as f(wo, wi) and returns a number, Rgb, Spectrum or std::array");
}

}  // namespace reflectree
