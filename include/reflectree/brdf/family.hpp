// SPDX-License-Identifier: Apache-2.0
// A family: a function with one or two material parameters that vary within ranges, as a texture does.
// It is anything callable: f(wo, wi, parameters), or f(geometry, parameters); at fixed parameters it is a
// BRDF (brdf.hpp), its member.
//
//   const auto matt_to_shiny = family([](Direction wo, Direction wi, const Parameters& p) { ... },
//                                     {{"width", 0.02f, 1}});
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/parameter.hpp"

namespace reflectree {

// clang-format off
template <class F>
concept DirectionFamily =
    std::is_invocable_v<const F&, Direction, Direction, const Parameters&> &&
    BrdfResult<std::remove_cvref_t<std::invoke_result_t<const F&, Direction, Direction, const Parameters&>>>;
template <class F>
concept GeometryFamily =
    std::is_invocable_v<const F&, const ShadingGeometry<float>&, const Parameters&> &&
    BrdfResult<std::remove_cvref_t<
        std::invoke_result_t<const F&, const ShadingGeometry<float>&, const Parameters&>>>;
template <class F>
concept FamilyFunction = DirectionFamily<F> || GeometryFamily<F>;
// Also in lanes of T.
template <class F, class T>
concept FamilyIn = std::is_invocable_v<const F&, const ShadingGeometry<T>&, const Parameters&>;
// clang-format on

template <FamilyFunction F>
struct Family {
  F f;
  std::vector<ParameterRange> ranges;  // one or two, of different names
  std::string name = "family";         // canonical material text where there is one
};
template <FamilyFunction F>
Family<F> family(F f, std::vector<ParameterRange> ranges, std::string name = "family") {
  return {std::move(f), std::move(ranges), std::move(name)};
}

template <class F>
inline constexpr bool is_family_v = false;
template <class F>
inline constexpr bool is_family_v<Family<F>> = true;

// A function that makes a BRDF of its own of each of its members: f.at(parameters).
template <class F>
concept MakesMembers = requires(const F& f, const Parameters& at) {
  { f.at(at) } -> Brdf;
};

namespace detail {
// What a member keeps, made once for all of its values.
template <class F>
struct KeptMember {
  KeptMember(const F&, const Parameters&) {}
};
template <MakesMembers F>
struct KeptMember<F> {
  decltype(std::declval<const F&>().at(std::declval<const Parameters&>())) model;
  KeptMember(const F& f, const Parameters& at) : model(f.at(at)) {}
};
}  // namespace detail

// A family at fixed parameters: a BRDF. Keeps a reference to the function.
template <FamilyFunction F>
struct FamilyMember {
  const F* f;
  Parameters at;
  [[no_unique_address]] detail::KeptMember<F> kept;

  FamilyMember(const F* function, const Parameters& parameters)
      : f(function), at(parameters), kept(*function, parameters) {}

  auto operator()(const ShadingGeometry<float>& g) const {
    if constexpr (MakesMembers<F>) {
      return detail::call(kept.model, g);
    } else if constexpr (GeometryFamily<F>) {
      return as_value((*f)(g, at));
    } else {
      return as_value((*f)(g.wo, g.wi, at));
    }
  }
  // In lanes, where f does it.
  template <class T>
  requires FamilyIn<F, T>
  auto operator()(const ShadingGeometry<T>& g) const {
    if constexpr (MakesMembers<F>) {
      return kept.model(g);
    } else {
      return (*f)(g, at);
    }
  }
  // What f tells of its members, where it does: traits(parameters).
  BrdfTraits traits() const {
    BrdfTraits traits;
    if constexpr (requires {
                    { f->traits(at) } -> std::convertible_to<BrdfTraits>;
                  }) {
      traits = f->traits(at);
    }
    return traits;
  }
  // Cheap, for who makes a member for every sample.
  bool may_be_turned() const {
    if constexpr (MakesMembers<F>) {
      if constexpr (requires { f->may_be_turned(kept.model); }) return f->may_be_turned(kept.model);
      return false;
    } else if constexpr (requires { f->may_be_turned(at); }) {
      return f->may_be_turned(at);
    } else {
      return false;
    }
  }
};

template <class F>
inline constexpr bool is_member_v<FamilyMember<F>> = true;

class FamilyEnclosure;  // enclosure.hpp

// A family chosen at run time. A value (shared, immutable inside).
class AnyFamily {
 public:
  template <FamilyFunction F>
  AnyFamily(Family<F> family) : self_(std::make_shared<const Model<F>>(std::move(family))) {}

  // Of every member, and the family's name. What differs from member to member is left out.
  const BrdfTraits& traits() const { return self_->traits; }
  int channels() const { return self_->traits.channels; }
  const std::vector<ParameterRange>& ranges() const { return self_->ranges; }

  // out[i * channels() + c]: channel c of f(geometry[i]) at parameters[i], for positive cosines.
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<const Parameters> parameters,
            std::span<float> out) const {
    self_->eval(geometry, parameters, out);
  }
  Spectrum operator()(const ShadingGeometry<float>& g, const Parameters& at) const {
    Spectrum value(channels());
    self_->eval({&g, 1}, {&at, 1}, {value.data(), std::size_t(channels())});
    return value;
  }
  BrdfTraits traits(const Parameters& at) const { return self_->traits_at(at); }
  bool may_be_turned(const Parameters&) const { return self_->traits.isotropic_by_formula; }
  // Bounds the family over boxes of directions and parameters (enclosure.hpp); empty: nobody can.
  const std::shared_ptr<const FamilyEnclosure>& enclosure() const { return self_->enclosure; }
  // The member at fixed parameters. Throws Error outside of the ranges.
  AnyBrdf member(const Parameters& at) const;

 private:
  struct Interface {
    BrdfTraits traits;
    std::vector<ParameterRange> ranges;
    std::shared_ptr<const FamilyEnclosure> enclosure;
    virtual ~Interface() = default;
    virtual BrdfTraits traits_at(const Parameters&) const = 0;
    virtual void eval(std::span<const ShadingGeometry<float>>, std::span<const Parameters>,
                      std::span<float>) const = 0;
  };

  template <FamilyFunction F>
  struct Model final : Interface {
    F f;
    explicit Model(Family<F> family) : f(std::move(family.f)) {
      check_ranges(family.ranges, family.name);
      this->ranges = std::move(family.ranges);
      // What all corners and the middle agree on.
      Parameters middle{};
      for (std::size_t i = 0; i < this->ranges.size(); ++i)
        middle[i] = linear_mix(0.5f, this->ranges[i].lo, this->ranges[i].hi);
      BrdfTraits& all = this->traits = traits_at(middle);
      for (unsigned corner = 0; corner < 1U << this->ranges.size(); ++corner) {
        Parameters at{};
        for (std::size_t i = 0; i < this->ranges.size(); ++i)
          at[i] = corner >> i & 1U ? this->ranges[i].hi : this->ranges[i].lo;
        const BrdfTraits one = traits_at(at);
        all.isotropic = all.isotropic && one.isotropic;
        all.isotropic_by_formula = all.isotropic_by_formula && one.isotropic_by_formula;
        if (one.axis && !all.axis) all.axis = one.axis;
        all.concurrent = all.concurrent && one.concurrent;
      }
      all.theta_o_factor = nullptr, all.sharp = nullptr, all.albedo = nullptr, all.enclosure = nullptr;
      if constexpr (requires { f.enclosure(this->ranges); }) this->enclosure = f.enclosure(this->ranges);
      all.name = family.name;
      if (all.channels < 1 || all.channels > max_channels) {
        throw Error("the family has " + std::to_string(all.channels) + " channels", all.name,
                    "give it 1 to " + std::to_string(max_channels));
      }
    }
    BrdfTraits traits_at(const Parameters& at) const override { return traits_of(FamilyMember<F>{&f, at}); }
    void eval(std::span<const ShadingGeometry<float>> geometry, std::span<const Parameters> parameters,
              std::span<float> out) const override {
      const int channels = this->traits.channels;
      if constexpr (requires { f.eval(geometry, parameters, out); }) {
        f.eval(geometry, parameters, out);
        return;
      } else {
        for (std::size_t i = 0; i < geometry.size(); ++i) {
          const auto value = FamilyMember<F>{&f, parameters[i]}(geometry[i]);
          if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, Spectrum>) {
            if (value.channels() != channels) detail::throw_channels(value.channels(), this->traits);
          }
          for (int c = 0; c < channels; ++c)
            out[i * std::size_t(channels) + std::size_t(c)] = channel_value(value, c);
        }
      }
    }
  };

  std::shared_ptr<const Interface> self_;
};

}  // namespace reflectree
