// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/material/description.hpp"
#include "reflectree/brdf/models/fresnel.hpp"

namespace reflectree {

// ABC model of a smooth surface: f = a (1 + b d^2)^-c F(cos_d), d the distance of the projected directions
// wi and -wo. Low et al. 2012, BRDF models for accurate and efficient rendering of glossy surfaces.
// With c = 1 and f0 = 1 (F = 1) everything is known in closed form: the oracle of the tests.
template <class N>
struct LowSmoothOf {
  Rgb a{1.f, 1.f, 1.f};
  N b = N(100.f);
  N c = N(1.f);
  Rgb f0{1.f, 1.f, 1.f};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    const T d2 = sqr(g.wo.x + g.wi.x) + sqr(g.wo.y + g.wi.y);
    const T lobe = exp(-T(c) * log1p(T(b) * d2));
    return lobe * (as_rgb<T>(a) * fresnel_schlick(f0, g.cos_theta_d));
  }

  BrdfTraits traits() const { return model_traits(*this); }
  static ModelDescription<LowSmoothOf> describe() {
    return {"low_smooth",
            ModelClass::experimental,
            "ABC lobe on the disk; c = 1, f0 = 1 has a closed-form albedo",
            "Low et al. 2012, BRDF models for accurate and efficient rendering of glossy surfaces",
            {{"a", &LowSmoothOf::a, 0, 1e4f, "1/sr", "value at the peak"},
             {"b", &LowSmoothOf::b, 1e-2f, 1e8f, "", "inverse squared width"},
             {"c", &LowSmoothOf::c, 0.05f, 10, "", "fall-off"},
             {"f0", &LowSmoothOf::f0, 0, 1, "", "Fresnel reflectance at normal incidence; 1 for none"}}};
  }
};
using LowSmooth = LowSmoothOf<float>;

// The albedo of a / (1 + b d^2), that is of LowSmooth with c = 1 and f0 = 1:
// (pi a / b) ln[(1 + b co^2 + sqrt(1 + 2 b (1 + r^2) + b^2 co^4)) / 2], r^2 = 1 - co^2.
inline double low_smooth_albedo(double a, double b, double cos_theta_o) {
  const double c2 = cos_theta_o * cos_theta_o;
  const double root = std::sqrt(1 + 2 * b * (2 - c2) + b * b * c2 * c2);
  return pi_v<double> * a / b * std::log((1 + b * c2 + root) / 2);
}

}  // namespace reflectree
