// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/material/description.hpp"
#include "reflectree/brdf/models/fresnel.hpp"

namespace reflectree {

// Trowbridge-Reitz (GGX) distribution per solid angle of the half vector; Walter et al. 2007, eq. 33,
// written with sin^2 theta_h so that it stays precise at the peak of the sharpest lobes.
template <class T>
T ggx_distribution(Vec3<T> wh, T alpha) {
  const T s = sin2_theta(wh) + sqr(alpha * wh.z);
  return sqr(alpha) / (pi_v<T> * s * s);
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

// GGX conductor: f = D F G2 / (4 cos_o cos_i), Fresnel by Schlick.
struct Ggx {
  float alpha = 0.1f;
  Rgb f0{1.f, 0.8f, 0.3f};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    const T d = ggx_distribution(g.wh, T(alpha));
    const T v = ggx_visibility(g.cos_theta_o, g.cos_theta_i, T(alpha));
    return d * v * fresnel_schlick(f0, g.cos_theta_d);
  }

  BrdfTraits traits() const { return model_traits(*this); }
  static ModelDescription<Ggx> describe() {
    return {"ggx",
            ModelClass::physical,
            "metal of microfacets: Trowbridge-Reitz, height-correlated Smith, Schlick's Fresnel term",
            "Walter et al. 2007, Microfacet models for refraction, eq. 33; Heitz 2014, eq. 99",
            {{"alpha", &Ggx::alpha, 1e-3f, 1, "", "microfacet width"},
             {"f0", &Ggx::f0, 0, 1, "", "Fresnel reflectance at normal incidence"}}};
  }
};

}  // namespace reflectree
