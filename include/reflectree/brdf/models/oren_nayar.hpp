// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/material/description.hpp"

namespace reflectree {

// Rough diffuse surface of V-cavities, the "qualitative model":
// f = rho / pi (A + B max(0, cos(phi_o - phi_i)) sin(max(theta)) tan(min(theta))).
// Oren and Nayar 1994. Not physical: near grazing the albedo is rho (A + B / 2), which reaches
// 1.015 rho at sigma = 0.22.
template <class N>
struct OrenNayarOf {
  Rgb rho{0.5f, 0.5f, 0.5f};
  N sigma = N(0.35f);

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    const T s2 = sqr(T(sigma));
    const T a = T(1) - T(0.5) * s2 / (s2 + T(0.33));
    const T b = T(0.45) * s2 / (s2 + T(0.09));
    // sin o sin i cos(dphi) = x x' + y y'; the smaller angle has the larger cosine.
    const T sines = max(g.wo.x * g.wi.x + g.wo.y * g.wi.y, T(0));
    const T sin_tan = sines / max(g.cos_theta_o, g.cos_theta_i);
    return (a + b * sin_tan) / pi_v<T> * as_rgb<T>(rho);
  }

  BrdfTraits traits() const { return model_traits(*this); }
  static ModelDescription<OrenNayarOf> describe() {
    return {
        "oren_nayar",
        ModelClass::approximate,
        "rough diffuse surface, qualitative model",
        "Oren and Nayar 1994, Generalization of Lambert's reflectance model",
        {{"rho", &OrenNayarOf::rho, 0, 1, "", "albedo of a facet"},
         {"sigma", &OrenNayarOf::sigma, 0, 1.5707964f, "rad", "standard deviation of the facets' angles"}}};
  }
};
using OrenNayar = OrenNayarOf<float>;

}  // namespace reflectree
