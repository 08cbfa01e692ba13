// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/material/description.hpp"
#include "reflectree/brdf/models/fresnel.hpp"
#include "reflectree/brdf/models/widths.hpp"

namespace reflectree {

// Beckmann distribution per solid angle of the half vector: exp(-tan^2 / alpha^2) / (pi alpha^2 cos^4), with
// the exponential of the caller's choice.
template <class T, class Exponential>
T beckmann_distribution(Vec3<T> wh, T alpha, const Exponential& exponential) {
  const T hz2 = max(sqr(wh.z), T(1e-18));  // keeps hz^4 a normal float
  const T a2 = sqr(alpha);
  return exponential(-sin2_theta(wh) / (a2 * hz2)) / (pi_v<T> * a2 * sqr(hz2));
}
// The same with two widths; sin2: sin2_by_widths of the half vector.
template <class T, class N>
T beckmann_distribution(T sin2, T cos_theta_h, WidthsOf<N> alpha) {
  const T hz2 = max(sqr(cos_theta_h), T(1e-18));
  const T slope2 = sin2 / hz2;
  return exp(-slope2) / (pi_v<T> * T(alpha.x) * T(alpha.y) * sqr(hz2));
}
template <class T, class N>
T beckmann_distribution(Vec3<T> wh, WidthsOf<N> alpha) {
  return beckmann_distribution(sin2_by_widths(wh, alpha), wh.z, alpha);
}
template <class T>
T beckmann_distribution(Vec3<T> wh, T alpha) {
  return beckmann_distribution(wh, alpha, [](T x) { return exp(x); });
}

// V-cavity masking-shadowing G = min(1, 2 hz co / cos_d, 2 hz ci / cos_d), over 4 co ci; Torrance and
// Sparrow 1967. min(co, ci) / (co ci) = 1 / max(co, ci).
template <class T>
T v_cavity_visibility(const ShadingGeometry<T>& g) {
  const T open = T(1) / (g.cos_theta_o * g.cos_theta_i);
  const T blocked = T(2) * g.cos_theta_h / (g.cos_theta_d * max(g.cos_theta_o, g.cos_theta_i));
  return T(0.25) * min(open, blocked);
}

// f = kd / pi + ks F D G / (4 co ci). Cook and Torrance 1982, with a normalised D and Walter et
// al.'s 1/4 (2007, eq. 20) in place of the paper's 1/pi, which gives four times too much light.
template <class N>
struct CookTorranceOf {
  Rgb kd{0.2f, 0.2f, 0.2f};
  Rgb ks{0.8f, 0.8f, 0.8f};
  Rgb f0{0.9f, 0.6f, 0.4f};
  WidthsOf<N> alpha = N(0.2f);
  Azimuth phi = {};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    const T d = alpha.round() ? beckmann_distribution(g.wh, T(alpha.x))
                              : beckmann_distribution(sin2_by_widths(g, alpha, phi), g.wh.z, alpha);
    const T lobe = d * v_cavity_visibility(g);
    return T(1) / pi_v<T> * as_rgb<T>(kd) + lobe * (as_rgb<T>(ks) * fresnel_schlick(f0, g.cos_theta_d));
  }

  BrdfTraits traits() const { return model_traits(*this, alpha.round()); }
  const char* fault() const { return sum_above_one(kd, ks) ? "kd + ks must not exceed 1" : nullptr; }
  static ModelDescription<CookTorranceOf> describe() {
    return {
        "cook_torrance",
        ModelClass::physical,
        "diffuse part and microfacets: Beckmann, V-cavities, Schlick's Fresnel term",
        "Cook and Torrance 1982, A reflectance model for computer graphics, normalised as Walter et al. 2007",
        {{"kd", &CookTorranceOf::kd, 0, 1, "", "diffuse albedo"},
         {"ks", &CookTorranceOf::ks, 0, 1, "", "weight of the microfacets"},
         {"f0", &CookTorranceOf::f0, 0, 1, "", "Fresnel reflectance at normal incidence"},
         {"alpha_x", typename ModelParameter<CookTorranceOf>::Width{&CookTorranceOf::alpha, &WidthsOf<N>::x},
          1e-3f, 1, "", "microfacet width along x (m in the paper)"},
         {"alpha_y", typename ModelParameter<CookTorranceOf>::Width{&CookTorranceOf::alpha, &WidthsOf<N>::y},
          1e-3f, 1, "", "microfacet width along y"},
         {"phi_deg", &CookTorranceOf::phi, -360, 360, "degrees", "azimuth of x"}}};
  }
};
using CookTorrance = CookTorranceOf<float>;

}  // namespace reflectree
