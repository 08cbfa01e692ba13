// SPDX-License-Identifier: Apache-2.0
// One sampler of every member of a family: the parameters are given with wo.
//
//   const auto sampler = make_sampler(model_family(Ggx{}, {{"alpha", 0.02f, 1}}));
//   auto s = sampler.exact.sample(wo, {alpha}, random);
//   auto q = sampler.one_shot.sample(wo, {alpha}, u1, u2);
//
// Parameters outside of their ranges, or not finite, are "no sample", as a wo below the horizon is.
#pragma once

#include "reflectree/sampler/sampler.hpp"

namespace reflectree {

namespace detail {

// The member of a single sample. It looks at the caller's parameters, which were as a rule written just now,
// in halves: a copy of both at once would have to wait for them to leave the store buffer.
template <MakesMembers F>
struct PassingMember {
  const F* f;
  const Parameters& at;
  KeptMember<F> kept;

  PassingMember(const F* function, const Parameters& parameters)
      : f(function), at(parameters), kept(*function, parameters) {}
  auto operator()(const ShadingGeometry<float>& g) const { return call(kept.model, g); }
  bool may_be_turned() const {
    if constexpr (requires { f->may_be_turned(kept.model); }) return f->may_be_turned(kept.model);
    return false;
  }
};
template <class F>
struct BorrowedMember {
  using type = FamilyMember<F>;
};
template <MakesMembers F>
struct BorrowedMember<F> {
  using type = PassingMember<F>;
};

}  // namespace detail
template <MakesMembers F>
inline constexpr bool is_member_v<detail::PassingMember<F>> = true;

// What both modes share. A member's sampler is a sampler like any other (exact_sampler.hpp,
// one_shot_sampler.hpp); `borrowed` ones must outlive neither this nor the parameters.
template <template <Brdf, class> class Mode, FamilyFunction F>
class FamilyMode {
 public:
  using Member = FamilyMember<F>;
  using Value = ValueOf<Member>;

  FamilyMode(std::shared_ptr<const Family<F>> family, std::shared_ptr<const PackedSampler> packed)
      : family_(std::move(family)), packed_(std::move(packed)) {}

  const Family<F>& family() const { return *family_; }
  const PackedSampler& packed() const { return *packed_; }
  // Shares the data, borrows the family.
  Mode<Member, std::shared_ptr<const PackedSampler>> at(const Parameters& parameters) const {
    return {Member{&family_->f, parameters}, packed_};
  }
  Mode<typename detail::BorrowedMember<F>::type, const PackedSampler*> borrowed(
      const Parameters& parameters) const {
    return {std::in_place, packed_.get(), &family_->f, parameters};
  }

  // One function to the optimiser, with the member and its sampler in registers.
  template <class... More>
  [[gnu::flatten]] std::optional<DirectionSample<Value>> sample(Direction wo, const Parameters& parameters,
                                                                More&&... more) const {
    return borrowed(parameters).sample(wo, std::forward<More>(more)...);
  }
  // Per solid angle, sr^-1.
  float pdf(Direction wo, Direction wi, const Parameters& parameters) const {
    return borrowed(parameters).pdf(wo, wi);
  }

 private:
  std::shared_ptr<const Family<F>> family_;
  std::shared_ptr<const PackedSampler> packed_;
};

template <FamilyFunction F>
struct FamilySampler {
  FamilyMode<ExactSampler, F> exact;
  FamilyMode<OneShotSampler, F> one_shot;
  // Both modes of one member; borrows the family.
  Sampler<FamilyMember<F>> at(const Parameters& parameters) const {
    return {exact.at(parameters), one_shot.at(parameters)};
  }
};

// From canonical data built for the family; throws Error if it was built for another.
template <FamilyFunction F>
FamilySampler<F> make_sampler(Family<F> family, const SamplerData& data) {
  check_identity(data, AnyFamily(family));
  auto packed = std::make_shared<const PackedSampler>(pack(data));
  auto shared = std::make_shared<const Family<F>>(std::move(family));
  return {{shared, packed}, {shared, packed}};
}
// Builds it.
template <FamilyFunction F>
FamilySampler<F> make_sampler(Family<F> family, const BuildOptions& options = {}, const Host& host = {}) {
  const SamplerData data = build(AnyFamily(family), options, host);
  return make_sampler(std::move(family), data);
}

}  // namespace reflectree
