// SPDX-License-Identifier: Apache-2.0
// A BRDF is anything callable: f(wo, wi), or f(geometry) for a model that wants the shading geometry.
// It returns a number, Rgb, Spectrum or std::array in sr^-1, *without* the cosine, and is safe to call
// concurrently unless its traits say otherwise. Refinements are detected, never demanded:
//   f.traits()                 what is known about f (knots, lobes, channels, symmetry, threads, name)
//   f.eval(wo, wi, out)        batches over spans; both directions vary
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "reflectree/brdf/shading_geometry.hpp"
#include "reflectree/brdf/value.hpp"

namespace reflectree {

// clang-format off
template <class F>
concept DirectionBrdf =
    std::is_invocable_v<const F&, Direction, Direction> &&
    BrdfResult<std::remove_cvref_t<std::invoke_result_t<const F&, Direction, Direction>>>;
template <class F>
concept GeometryBrdf =
    std::is_invocable_v<const F&, const ShadingGeometry<float>&> &&
    BrdfResult<std::remove_cvref_t<std::invoke_result_t<const F&, const ShadingGeometry<float>&>>>;
template <class F>
concept Brdf = GeometryBrdf<F> || DirectionBrdf<F>;
// clang-format on

namespace detail {
template <class F>
auto call(const F& f, const ShadingGeometry<float>& g) {
  if constexpr (GeometryBrdf<F>) {
    return as_value(f(g));
  } else {
    return as_value(f(g.wo, g.wi));
  }
}
}  // namespace detail

template <Brdf F>
using ValueOf = decltype(detail::call(std::declval<const F&>(), ShadingGeometry<float>{}));

// f at a geometry whose cosines are both positive.
template <Brdf F>
ValueOf<F> eval(const F& f, const ShadingGeometry<float>& g) {
  return detail::call(f, g);
}

namespace detail {
// Zero in as many channels as f has; a function of run-time channels is asked, at the normal.
template <class F>
ValueOf<F> zero_of(const F& f) {
  if constexpr (std::is_same_v<ValueOf<F>, Spectrum>) {
    constexpr Direction normal{0, 0, 1};
    return zero_like(call(f, ShadingGeometry<float>{normal, normal, normal, 1, 1, 1, 1}));
  } else {
    return {};
  }
}
}  // namespace detail

// f(wo, wi) in sr^-1; zero unless both directions lie above the surface.
template <Brdf F>
ValueOf<F> eval(const F& f, Direction wo, Direction wi) {
  if (!(wo.z > 0 && wi.z > 0)) return detail::zero_of(f);
  if constexpr (GeometryBrdf<F>) {
    return as_value(f(shading_geometry(wo, wi)));
  } else {
    return as_value(f(wo, wi));
  }
}

// A lobe narrower than what a builder sees by itself (a hundredth of a radian): it is looked at closely.
struct SharpLobe {
  Direction centre;  // wi, unit
  float width;       // radians, about: where f has fallen to a third
};

// Azimuths of wo at which an anisotropic f leaps or bends, for all elevations from where the band before ends.
struct AzimuthKnots {
  float theta_o_end;         // radians
  std::vector<float> phi_o;  // radians, in any order
};

// A band of wi, from the elevation where the band before ends, cut into patches at azimuths.
struct PatchBand {
  float theta_i_end;         // radians; of the last band pi/2
  std::vector<float> phi_i;  // radians, in any order; none: one patch
};

class BrdfEnclosure;  // enclosure.hpp

// What a function may tell about itself. The builder verifies what it can.
struct BrdfTraits {
  std::string name = "lambda";  // canonical material text where there is one
  int channels = 3;
  bool isotropic = true;              // false: known to depend on more than phi_o - phi_i
  bool isotropic_by_formula = false;  // may be evaluated with both directions turned about the normal
  // Of an anisotropic function: the azimuth of a plane in which both directions may be mirrored, radians.
  // Only a hint; the builder verifies it, and looks for one itself.
  std::optional<float> axis = std::nullopt;
  bool concurrent = true;            // false: called from one thread (a Python callback)
  std::vector<float> theta_o_knots;  // radians: elevations where f has kinks in theta_o
  std::vector<float> theta_d_knots;  // radians: difference angles where f has kinks; theta_o meets them at a
                                     // mirror lobe, where the albedo inherits them
  std::vector<AzimuthKnots> phi_o_knots;  // bands of theta_o, ascending
  // Of a function that is constant in wi over patches, for every wo: bands from the normal to the horizon.
  std::vector<PatchBand> patches;
  // Of a function of one channel: the integral of f cos_i over the hemisphere for a viewer, known exactly.
  // Empty: cubature finds it, as it checks what is told.
  std::function<double(Direction wo)> albedo;
  // A factor of f that depends on theta_o (radians) alone, > 0; empty: none known. Albedo tables interpolate
  // what is left of the albedo without it, so that its kinks cost no integral.
  std::function<double(double)> theta_o_factor;
  // The sharp lobes of f for a viewer wo; empty: none known. Only hints: a lobe told of wrongly costs time.
  std::function<std::vector<SharpLobe>(Direction wo)> sharp;
  // Bounds f over boxes of directions, so that a sampler's bounds can be proved; empty: nobody can.
  std::shared_ptr<const BrdfEnclosure> enclosure;
};

template <class F>
concept BatchBrdf = Brdf<F> && requires(const F& f, std::span<const Direction> w, std::span<ValueOf<F>> out) {
  f.eval(w, w, out);
};

template <Brdf F>
BrdfTraits traits_of(const F& f) {
  BrdfTraits traits;
  if constexpr (requires {
                  { f.traits() } -> std::convertible_to<BrdfTraits>;
                }) {
    traits = f.traits();
  }
  if constexpr (std::is_same_v<ValueOf<F>, float>) traits.channels = 1;
  if constexpr (std::is_same_v<ValueOf<F>, Rgb>) traits.channels = 3;
  if constexpr (std::is_same_v<ValueOf<F>, Spectrum> && !requires { f.traits(); }) {
    traits.channels = channels_of(detail::zero_of(f));
  }
  return traits;
}

// Whether f says that it may be evaluated with both directions turned about the normal.
template <Brdf F>
bool is_isotropic_by_formula(const F& f) {
  if constexpr (requires {
                  { f.may_be_turned() } -> std::convertible_to<bool>;
                }) {
    return f.may_be_turned();  // without the cost of all traits
  } else if constexpr (requires {
                         { f.traits() } -> std::convertible_to<BrdfTraits>;
                       }) {
    return f.traits().isotropic_by_formula;
  } else {
    return false;
  }
}

// A function that writes its channels: write(wo, wi, out), for values that live in arrays of its own.
//   channel_brdf(31, [](Direction wo, Direction wi, std::span<float> out) { ... })
template <class Write>
requires std::is_invocable_v<const Write&, Direction, Direction, std::span<float>>
struct ChannelBrdf {
  int channels;
  Write write;
  Spectrum operator()(Direction wo, Direction wi) const {
    Spectrum value(channels);
    write(wo, wi, std::span<float>(value.data(), std::size_t(channels)));
    return value;
  }
};
// channels: 1 to max_channels.
template <class Write>
ChannelBrdf<Write> channel_brdf(int channels, Write write) {
  return {channels, std::move(write)};
}

}  // namespace reflectree
