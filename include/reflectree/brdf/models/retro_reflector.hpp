// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lobe.hpp"

namespace reflectree {

// The geometry of wo and of wi mirrored about the normal.
template <class T>
ShadingGeometry<T> back_geometry(const ShadingGeometry<T>& g) {
  return shading_geometry(g.wo, mirror_direction(g.wi));
}

// GGX with wi mirrored about the normal: the peak lies at wi = wo ("back vector"). Mirroring preserves
// measure and cosine, so the albedo is that of Ggx. Belcour et al. 2014.
template <class N>
struct RetroReflectorOf {
  WidthsOf<N> alpha = N(0.1f);
  Rgb f0{0.8f, 0.8f, 0.8f};
  Azimuth phi = {};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    return GgxOf<N>{alpha, f0, phi}(back_geometry(g));
  }

  BrdfTraits traits() const { return model_traits(*this, alpha.round()); }
  static ModelDescription<RetroReflectorOf> describe() {
    return {"retro_reflector",
            ModelClass::physical,
            "GGX lobe about the direction of the viewer",
            "Belcour et al. 2014, BRDF measurements and analysis of retroreflective materials; Walter et al. "
            "2007",
            {{"alpha_x",
              typename ModelParameter<RetroReflectorOf>::Width{&RetroReflectorOf::alpha, &WidthsOf<N>::x},
              1e-3f, 1, "", "microfacet width along x"},
             {"alpha_y",
              typename ModelParameter<RetroReflectorOf>::Width{&RetroReflectorOf::alpha, &WidthsOf<N>::y},
              1e-3f, 1, "", "microfacet width along y"},
             {"f0", &RetroReflectorOf::f0, 0, 1, "", "Fresnel reflectance at normal incidence"},
             {"phi_deg", &RetroReflectorOf::phi, -360, 360, "degrees", "azimuth of x"}}};
  }
};
using RetroReflector = RetroReflectorOf<float>;

}  // namespace reflectree
