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
struct RetroReflector {
  Widths alpha = 0.1f;
  Rgb f0{0.8f, 0.8f, 0.8f};
  Azimuth phi = {};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    return Ggx{alpha, f0, phi}(back_geometry(g));
  }

  BrdfTraits traits() const { return model_traits(*this, alpha.round()); }
  static ModelDescription<RetroReflector> describe() {
    return {"retro_reflector",
            ModelClass::physical,
            "GGX lobe about the direction of the viewer",
            "Belcour et al. 2014, BRDF measurements and analysis of retroreflective materials; Walter et al. "
            "2007",
            {{"alpha_x", ModelParameter<RetroReflector>::Width{&RetroReflector::alpha, &Widths::x}, 1e-3f, 1,
              "", "microfacet width along x"},
             {"alpha_y", ModelParameter<RetroReflector>::Width{&RetroReflector::alpha, &Widths::y}, 1e-3f, 1,
              "", "microfacet width along y"},
             {"f0", &RetroReflector::f0, 0, 1, "", "Fresnel reflectance at normal incidence"},
             {"phi_deg", &RetroReflector::phi, -360, 360, "degrees", "azimuth of x"}}};
  }
};

}  // namespace reflectree
