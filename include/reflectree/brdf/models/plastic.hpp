// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/models/ggx.hpp"

namespace reflectree {

// A smooth diffuse base under a rough dielectric coat: GGX with Schlick's Fresnel term, and what the coat
// lets in and out again, kd / pi (1 - F(co)) (1 - F(ci)), reciprocal as in Shirley et al. 1997. Dividing by
// the mean of 1 - F would give a white base back all that the coat passes, but then the albedo exceeds 1
// (by 0.0024 at alpha = 0.2, f0 = 0, 50 degrees): a rough coat reflects more than F(co).
template <class N>
struct PlasticOf {
  Rgb kd{0.1f, 0.3f, 0.6f};
  N f0 = N(0.04f);
  WidthsOf<N> alpha = N(0.1f);
  Azimuth phi = {};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    const T f = T(f0);
    const GgxLobe<T> lobe = ggx_lobe(g, alpha, phi);
    const T coat = (f + (T(1) - f) * schlick_power(g.cos_theta_d)) * lobe.distribution * lobe.visibility;
    // 1 - F(c) = (1 - f0) (1 - (1 - c)^5).
    const T base =
        sqr(T(1) - f) / pi_v<T> * schlick_complement(g.cos_theta_o) * schlick_complement(g.cos_theta_i);
    return base * as_rgb<T>(kd) + RgbT<T>{coat, coat, coat};
  }

  BrdfTraits traits() const { return model_traits(*this, alpha.round()); }
  static ModelDescription<PlasticOf> describe() {
    return {"plastic",
            ModelClass::physical,
            "smooth diffuse base under a rough dielectric coat (GGX)",
            "Shirley et al. 1997, A practitioners' assessment of light reflection models; Walter et al. 2007",
            {{"kd", &PlasticOf::kd, 0, 1, "", "albedo of the base"},
             {"f0", &PlasticOf::f0, 0, 1, "", "Fresnel reflectance of the coat at normal incidence"},
             {"alpha_x", typename ModelParameter<PlasticOf>::Width{&PlasticOf::alpha, &WidthsOf<N>::x}, 1e-3f,
              1, "", "microfacet width of the coat along x"},
             {"alpha_y", typename ModelParameter<PlasticOf>::Width{&PlasticOf::alpha, &WidthsOf<N>::y}, 1e-3f,
              1, "", "microfacet width of the coat along y"},
             {"phi_deg", &PlasticOf::phi, -360, 360, "degrees", "azimuth of x"}}};
  }
};
using Plastic = PlasticOf<float>;

}  // namespace reflectree
