// SPDX-License-Identifier: Apache-2.0
// Every check of this room on one sampler, in one call; `reflectree verify` is this call and prints its report.
//
//   const auto report = reflectree::verify(my_brdf);     // builds a sampler and judges it
//   const auto report = reflectree::verify(sampler);     // judges one that is built
//   if (!report.all_passed()) for (const auto& check : report.checks) puts(to_line(check).c_str());
//
// What is drawn is judged by what f is: f is evaluated in the caller's frame, at random azimuths, integrated
// by a cubature that shares no code with the builder, its target reduced by the referee's own formula. The
// family of all statistical tests errs once in 1 / family_significance sound runs.
#pragma once

#include "reflectree/sampler/family_sampler.hpp"
#include "reflectree/verify/verify_suspect.hpp"
#include "reflectree/verify/ways.hpp"

namespace reflectree {

// data: the canonical form that the sampler was made from; without it nothing can be said about packing, and
// bounds are judged by trials alone.
template <Brdf F>
VerifyReport verify(const Sampler<F>& sampler, const SamplerData* data = nullptr,
                    const VerifyOptions& options = {}, const Host& host = {}) {
  return verify(suspect(sampler, AnyBrdf(sampler.exact.brdf()), data), options, host);
}
template <Brdf F>
VerifyReport verify(const Sampler<F>& sampler, const VerifyOptions& options, const Host& host = {}) {
  return verify(sampler, nullptr, options, host);
}
template <Brdf F>
VerifyReport verify(const F& f, const VerifyOptions& options = {}, const BuildOptions& build_options = {},
                    const Host& host = {}) {
  const SamplerData data = build(AnyBrdf(f), build_options, host);
  const auto sampler = make_sampler(f, data);
  return verify(sampler, &data, options, host);
}

// Of a family: members one after the other, the effort shared among them.
template <FamilyFunction F>
VerifyReport verify(const FamilySampler<F>& sampler, const SamplerData* data = nullptr,
                    const VerifyOptions& options = {}, const Host& host = {}) {
  const AnyFamily any(sampler.exact.family());
  const auto judge = [&](const Parameters& at, const VerifyOptions& each, const Host& part) {
    const Sampler<FamilyMember<F>> member = sampler.at(at);
    Suspect one = suspect(member, any.member(at), data);
    one.family = any, one.at = at;
    return verify(one, each, part);
  };
  return verify_members(any.ranges(), judge, options, host);
}

}  // namespace reflectree
