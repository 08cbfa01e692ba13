// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/material/description.hpp"
#include "reflectree/brdf/models/fresnel.hpp"

namespace reflectree {

// f = 28 kd / (23 pi) (1 - f0) (1 - (1 - co/2)^5) (1 - (1 - ci/2)^5)
//   + sqrt((nx+1)(ny+1)) / (8 pi) hz^((nx hx^2 + ny hy^2) / (1 - hz^2)) F(cos_d) / (cos_d max(co, ci)).
// Ashikhmin and Shirley 2000 (their nu, nv are n_x, n_y; Rd, Rs are kd, f0).
template <class N>
struct AshikhminShirleyOf {
  Rgb kd{0.3f, 0.3f, 0.3f};
  Rgb f0{0.05f, 0.05f, 0.05f};
  N n_x = N(100.f);
  N n_y = N(100.f);
  Azimuth phi = {};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    // hz^e with hz^2 = 1 / (1 + tan^2): precise at the pole and at the rim. e, a mean of n_x and n_y, is 0/0
    // at the pole, where the power is 1 whatever e is.
    const T s2 = sin2_theta(g.wh);
    const T tan2 = s2 / max(sqr(g.cos_theta_h), T(1e-18));
    const Vec3<T> wh = in_frame_of(phi, g.wh);
    const T mean = (T(n_x) * sqr(wh.x) + T(n_y) * sqr(wh.y)) / max(s2, T(1e-30));
    const T exponent = clamp(mean, min(T(n_x), T(n_y)), max(T(n_x), T(n_y)));
    const T power = exp(T(-0.5) * exponent * log1p(tan2));
    const T scale = sqrt((T(n_x) + T(1)) * (T(n_y) + T(1))) / (T(8) * pi_v<T>);
    const T lobe = scale * power / (g.cos_theta_d * max(g.cos_theta_o, g.cos_theta_i));

    const T white = T(28) / (T(23) * pi_v<T>)*schlick_complement(T(0.5) * g.cos_theta_o) *
                    schlick_complement(T(0.5) * g.cos_theta_i);
    const Rgb under = kd * (Rgb{1, 1, 1} - f0);
    return white * as_rgb<T>(under) + lobe * fresnel_schlick(f0, g.cos_theta_d);
  }

  BrdfTraits traits() const { return model_traits(*this, n_x == n_y); }
  static ModelDescription<AshikhminShirleyOf> describe() {
    return {"ashikhmin_shirley",
            ModelClass::physical,
            "Phong-like lobe of the half vector with Fresnel term over a coupled diffuse part",
            "Ashikhmin and Shirley 2000, An anisotropic Phong BRDF model",
            {{"kd", &AshikhminShirleyOf::kd, 0, 1, "", "diffuse albedo (Rd)"},
             {"f0", &AshikhminShirleyOf::f0, 0, 1, "", "specular reflectance at normal incidence (Rs)"},
             {"n_x", &AshikhminShirleyOf::n_x, 1, 1e6f, "", "exponent along x (nu)"},
             {"n_y", &AshikhminShirleyOf::n_y, 1, 1e6f, "", "exponent along y (nv)"},
             {"phi_deg", &AshikhminShirleyOf::phi, -360, 360, "degrees", "azimuth of x"}}};
  }
};
using AshikhminShirley = AshikhminShirleyOf<float>;

}  // namespace reflectree
