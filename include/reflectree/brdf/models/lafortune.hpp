// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/material/description.hpp"
#include "reflectree/brdf/models/lobe.hpp"

namespace reflectree {

// One generalised cosine lobe, every coefficient per channel:
// f = kd / pi + ks (n + 2) / (2 pi) max(0, cx x x' + cy y y' + cz z z')^n.
// Lafortune et al. 1997; the paper hides ks (n + 2) / (2 pi) inside the c, which overflows for
// large n. More lobes: a sum of terms. cx = cy = -1, cz = 1 is Phong's lobe; cx = cy > 0 retro-reflects.
struct Lafortune {
  Rgb kd{0.2f, 0.2f, 0.2f};
  Rgb ks{0.5f, 0.5f, 0.5f};
  Rgb cx{-1.f, -1.f, -1.f};
  Rgb cy{-1.f, -1.f, -1.f};
  Rgb cz{0.95f, 0.95f, 0.95f};
  Rgb n{20.f, 20.f, 20.f};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    const RgbT<T> lobe = {power(g, T(cx.r), T(cy.r), T(cz.r), T(n.r)),
                          power(g, T(cx.g), T(cy.g), T(cz.g), T(n.g)),
                          power(g, T(cx.b), T(cy.b), T(cz.b), T(n.b))};
    return T(1) / pi_v<T> * as_rgb<T>(kd) + lobe * as_rgb<T>(ks);
  }

  BrdfTraits traits() const { return model_traits(*this, cx == cy); }
  const char* fault() const {
    for (int c = 0; c < 3; ++c) {
      const float longest =
          max(max(abs(channel_value(cx, c)), abs(channel_value(cy, c))), abs(channel_value(cz, c)));
      if (channel_value(n, c) * log(longest) > 14.f)
        return "the largest of |cx|, |cy|, |cz|, to the power n, must not exceed 1e6";
    }
    return nullptr;
  }
  static ModelDescription<Lafortune> describe() {
    return {"lafortune",
            ModelClass::approximate,
            "generalised cosine lobe, off-specular or retro-reflective",
            "Lafortune et al. 1997, Non-linear approximation of reflectance functions",
            {{"kd", &Lafortune::kd, 0, 1, "", "diffuse albedo"},
             {"ks", &Lafortune::ks, 0, 1, "", "weight of the lobe"},
             {"cx", &Lafortune::cx, -1.5f, 1.5f, "", "coefficient of x x'"},
             {"cy", &Lafortune::cy, -1.5f, 1.5f, "", "coefficient of y y'; isotropic if equal to cx"},
             {"cz", &Lafortune::cz, -1.5f, 1.5f, "", "coefficient of z z'"},
             {"n", &Lafortune::n, 1, 1e5f, "", "exponent"}}};
  }

 private:
  // (n + 2) / (2 pi) max(0, m.wi)^n with m = (cx x, cy y, cz z). m.wi = |m| (1 - versine), and
  // |m|^2 - 1 = sum (c^2 - 1) x^2, so that nothing cancels where |c| is close to 1.
  template <class T>
  static T power(const ShadingGeometry<T>& g, T a, T b, T c, T exponent) {
    const T excess =
        (sqr(a) - T(1)) * sqr(g.wo.x) + (sqr(b) - T(1)) * sqr(g.wo.y) + (sqr(c) - T(1)) * sqr(g.wo.z);
    const Vec3<T> m = {a * g.wo.x, b * g.wo.y, c * g.wo.z};
    const Vec3<T> axis = T(1) / sqrt(max(dot(m, m), T(1e-30))) * m;
    const T length_power = exp(T(0.5) * exponent * log1p(max(excess, T(-1))));
    return (exponent + T(2)) / (T(2) * pi_v<T>)*length_power * cos_power(versine(g.wi, axis), exponent);
  }
};

}  // namespace reflectree
