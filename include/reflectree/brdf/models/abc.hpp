// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/brdf/models/fresnel.hpp"

namespace reflectree {

// x G / (pi cos_o cos_i). (Boxes: enclosed_fits.hpp.)
template <class T>
T abc_shadowed(T x, const ShadingGeometry<T>& g) {
  const T facing = T(2) * g.cos_theta_h / g.cos_theta_d;
  const T masking = min(T(1), facing * min(g.cos_theta_o, g.cos_theta_i));
  return x * masking / (pi_v<T> * g.cos_theta_o * g.cos_theta_i);
}

// ABC microfacet model: f = kd / pi + F S G / (pi cos_o cos_i) with S = A / (1 + B (1 - cos theta_h))^C,
// G of Cook and Torrance 1982, F the Fresnel equation of an unpolarised dielectric; ior >= 1.
// Löw, Kronander, Ynnerman, Unger 2012, "BRDF Models for Accurate and Efficient Rendering of Glossy Surfaces".
struct AbcMicrofacet {
  std::string name = "abc";
  Rgb kd, a;
  float b = 0, c = 1, ior = 1.5f;

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    // 1 - cos theta_h = sin^2 theta_h / (1 + cos theta_h), without cancellation at the peak.
    const T versine = sin2_theta(g.wh) / (T(1) + g.cos_theta_h);
    const T lobe = exp(-T(c) * log(T(1) + T(b) * versine));
    const T n2 = T(ior) * T(ior);
    const T root = sqrt(max(n2 + sqr(g.cos_theta_d) - T(1), T(0)));
    const T fresnel = fresnel_dielectric(g.cos_theta_d, root, n2);
    const T specular = abc_shadowed(fresnel * lobe, g);
    return T(1) / pi_v<T> * as_rgb<T>(kd) + specular * as_rgb<T>(a);
  }
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.isotropic_by_formula = true;
    traits.name = name;
    return traits;
  }
};

}  // namespace reflectree
