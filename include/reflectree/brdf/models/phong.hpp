// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/material/description.hpp"
#include "reflectree/brdf/models/lobe.hpp"

namespace reflectree {

// Modified Phong: f = kd / pi + ks (n + 2) / (2 pi) max(0, cos alpha)^n, alpha the angle between wi and
// the mirror direction of wo. Lafortune and Willems 1994.
template <class N>
struct PhongOf {
  Rgb kd{0.2f, 0.2f, 0.2f};
  Rgb ks{0.6f, 0.6f, 0.6f};
  N n = N(50.f);

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    const T lobe = (T(n) + T(2)) / (T(2) * pi_v<T>)*cos_power(versine(g.wi, mirror_direction(g.wo)), T(n));
    return T(1) / pi_v<T> * as_rgb<T>(kd) + lobe * as_rgb<T>(ks);
  }

  BrdfTraits traits() const { return model_traits(*this); }
  const char* fault() const { return sum_above_one(kd, ks) ? "kd + ks must not exceed 1" : nullptr; }
  static ModelDescription<PhongOf> describe() {
    return {"phong",
            ModelClass::physical,
            "diffuse part and cosine-power lobe about the mirror direction",
            "Lafortune and Willems 1994, Using the modified Phong reflectance model",
            {{"kd", &PhongOf::kd, 0, 1, "", "diffuse albedo"},
             {"ks", &PhongOf::ks, 0, 1, "", "albedo of the lobe at normal incidence"},
             {"n", &PhongOf::n, 1, 1e6f, "", "exponent"}}};
  }
};
using Phong = PhongOf<float>;

}  // namespace reflectree
