// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/material/description.hpp"
#include "reflectree/brdf/models/fresnel.hpp"
#include "reflectree/brdf/models/widths.hpp"

namespace reflectree {

// sin^2 + alpha^2 cos^2 of the elevation of w.
template <class T>
T stretched_sin2_theta(Vec3<T> w, T alpha) {
  return sin2_theta(w) + sqr(alpha * w.z);
}

// Trowbridge-Reitz (GGX) distribution per solid angle of the half vector; Walter et al. 2007, eq. 33,
// written with sin^2 theta_h so that it stays precise at the peak of the sharpest lobes.
template <class T>
T ggx_distribution(Vec3<T> wh, T alpha) {
  const T s = stretched_sin2_theta(wh, alpha);
  return sqr(alpha) / (pi_v<T> * s * s);
}

// The same with two widths; Heitz 2014, eq. 85. sin2: sin2_by_widths of the half vector.
template <class T, class N>
T ggx_distribution(T sin2, T cos_theta_h, WidthsOf<N> alpha) {
  const T s = sin2 + sqr(cos_theta_h);
  return T(1) / (pi_v<T> * T(alpha.x) * T(alpha.y) * s * s);
}
template <class T, class N>
T ggx_distribution(Vec3<T> wh, WidthsOf<N> alpha) {
  return ggx_distribution(sin2_by_widths(wh, alpha), wh.z, alpha);
}

// Smith's masking of one direction, 2 / (1 + sqrt(1 + alpha^2 tan^2 theta)); Walter et al. 2007, eq. 34.
template <class T>
T ggx_masking(Vec3<T> w, T alpha) {
  return T(2) / (T(1) + sqrt(T(1) + sqr(alpha) * sin2_theta(w) / sqr(w.z)));
}

// Height-correlated Smith masking-shadowing over 4 cos_o cos_i; Heitz 2014, eq. 99:
// G2 / (4 co ci) = 1 / (2 (co sqrt(a2 + (1 - a2) ci^2) + ci sqrt(a2 + (1 - a2) co^2))).
template <class T>
T ggx_visibility(T cos_theta_o, T cos_theta_i, T alpha) {
  const T a2 = sqr(alpha);
  const T lambda_i = cos_theta_o * sqrt(a2 + (T(1) - a2) * sqr(cos_theta_i));
  const T lambda_o = cos_theta_i * sqrt(a2 + (T(1) - a2) * sqr(cos_theta_o));
  return T(0.5) / (lambda_i + lambda_o);
}

// The same with two widths: alpha^2 sin^2 theta becomes alpha_x^2 x^2 + alpha_y^2 y^2.
template <class T, class N>
T ggx_visibility(Vec3<T> wo, Vec3<T> wi, WidthsOf<N> alpha) {
  const auto widened = [&](const Vec3<T>& w) {
    return sqrt(sqr(w.z) + sqr(T(alpha.x) * w.x) + sqr(T(alpha.y) * w.y));
  };
  return T(0.5) / (wo.z * widened(wi) + wi.z * widened(wo));
}
// D and G2 / (4 cos_o cos_i) of a surface whose x axis lies at an azimuth.
template <class T>
struct GgxLobe {
  T distribution, visibility;
};
// Out of line: the round lobe, which most are, stays small enough to vanish in the loop that samples it.
template <class T, class N>
REFLECTREE_NOINLINE GgxLobe<T> ggx_elliptic_lobe(const ShadingGeometry<T>& g, WidthsOf<N> alpha,
                                                 const Azimuth& phi) {
  return {ggx_distribution(sin2_by_widths(g, alpha, phi), g.wh.z, alpha),
          ggx_visibility(in_frame_of(phi, g.wo), in_frame_of(phi, g.wi), alpha)};
}
template <class T, class N>
REFLECTREE_INLINE GgxLobe<T> ggx_lobe(const ShadingGeometry<T>& g, WidthsOf<N> alpha, const Azimuth& phi) {
  if (!alpha.round()) return ggx_elliptic_lobe(g, alpha, phi);
  return {ggx_distribution(g.wh, T(alpha.x)), ggx_visibility(g.cos_theta_o, g.cos_theta_i, T(alpha.x))};
}

// GGX conductor: f = D F G2 / (4 cos_o cos_i), Fresnel by Schlick.
template <class N>
struct GgxOf {
  WidthsOf<N> alpha = N(0.1f);
  Rgb f0{1.f, 0.8f, 0.3f};
  Azimuth phi = {};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    const GgxLobe<T> lobe = ggx_lobe(g, alpha, phi);
    return lobe.distribution * lobe.visibility * fresnel_schlick(f0, g.cos_theta_d);
  }

  BrdfTraits traits() const { return model_traits(*this, alpha.round()); }
  static ModelDescription<GgxOf> describe() {
    return {"ggx",
            ModelClass::physical,
            "metal of microfacets: Trowbridge-Reitz, height-correlated Smith, Schlick's Fresnel term",
            "Walter et al. 2007, Microfacet models for refraction, eq. 33; Heitz 2014, eq. 99",
            {{"alpha_x", typename ModelParameter<GgxOf>::Width{&GgxOf::alpha, &WidthsOf<N>::x}, 1e-3f, 1, "",
              "microfacet width along x"},
             {"alpha_y", typename ModelParameter<GgxOf>::Width{&GgxOf::alpha, &WidthsOf<N>::y}, 1e-3f, 1, "",
              "microfacet width along y"},
             {"f0", &GgxOf::f0, 0, 1, "", "Fresnel reflectance at normal incidence"},
             {"phi_deg", &GgxOf::phi, -360, 360, "degrees", "azimuth of x"}}};
  }
};
using Ggx = GgxOf<float>;

}  // namespace reflectree
