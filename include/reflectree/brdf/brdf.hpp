// SPDX-License-Identifier: Apache-2.0
// A BRDF is anything callable: f(wo, wi), or f(geometry) for a model that wants the shading geometry.
// It returns float, Rgb or Spectrum in sr^-1, *without* the cosine, and is safe to call concurrently
// unless its traits say otherwise. Refinements are detected, never demanded:
//   f.traits()                 what is known about f (knots, channels, symmetry, threads, name)
//   f.eval(wo, wi, out)        batches over spans; both directions vary
#pragma once

#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "reflectree/brdf/shading_geometry.hpp"
#include "reflectree/brdf/value.hpp"

namespace reflectree {

template <class F>
concept DirectionBrdf = std::is_invocable_v<const F&, Direction, Direction> &&
    BrdfValue<std::remove_cvref_t<std::invoke_result_t<const F&, Direction, Direction>>>;
template <class F>
concept GeometryBrdf = std::is_invocable_v < const F&,
        const ShadingGeometry<float>
& > &&BrdfValue<std::remove_cvref_t<std::invoke_result_t<const F&, const ShadingGeometry<float>&>>>;
template <class F>
concept Brdf = GeometryBrdf<F> || DirectionBrdf<F>;

namespace detail {
template <class F>
auto call(const F& f, const ShadingGeometry<float>& g) {
  if constexpr (GeometryBrdf<F>) {
    return f(g);
  } else {
    return f(g.wo, g.wi);
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

// f(wo, wi) in sr^-1; zero unless both directions lie above the surface.
template <Brdf F>
ValueOf<F> eval(const F& f, Direction wo, Direction wi) {
  if constexpr (GeometryBrdf<F>) {
    if (wo.z > 0 && wi.z > 0) return f(shading_geometry(wo, wi));
    return zero_like(f(shading_geometry(Direction{0, 0, 1}, Direction{0, 0, 1})));
  } else {
    if (wo.z > 0 && wi.z > 0) return f(wo, wi);
    return zero_like(f(Direction{0, 0, 1}, Direction{0, 0, 1}));
  }
}

// What a function may tell about itself. The builder verifies what it can.
struct BrdfTraits {
  std::string name = "lambda";  // canonical material text where there is one
  int channels = 3;
  bool isotropic = true;             // depends on phi_o - phi_i only
  bool concurrent = true;            // false: called from one thread (a Python callback)
  std::vector<float> theta_o_knots;  // radians: elevations where f has kinks in theta_o
  std::vector<float> theta_d_knots;  // radians: difference angles where f has kinks; theta_o meets them at a
                                     // mirror lobe, where the albedo inherits them
  // A factor of f that depends on theta_o (radians) alone, > 0; empty: none known. Albedo tables interpolate
  // what is left of the albedo without it, so that its kinks cost no integral.
  std::function<double(double)> theta_o_factor;
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
  return traits;
}

}  // namespace reflectree
