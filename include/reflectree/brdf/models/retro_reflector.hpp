// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lobe.hpp"

namespace reflectree {

// GGX with wi mirrored about the normal: the peak lies at wi = wo ("back vector"). Mirroring preserves
// measure and cosine, so the albedo is that of Ggx. Belcour et al. 2014.
struct RetroReflector {
  float alpha = 0.1f;
  Rgb f0{0.8f, 0.8f, 0.8f};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    return Ggx{alpha, f0}(shading_geometry(g.wo, mirror_direction(g.wi)));
  }

  BrdfTraits traits() const { return model_traits(*this); }
  static ModelDescription<RetroReflector> describe() {
    return {"retro_reflector",
            ModelClass::physical,
            "GGX lobe about the direction of the viewer",
            "Belcour et al. 2014, BRDF measurements and analysis of retroreflective materials; Walter et al. "
            "2007",
            {{"alpha", &RetroReflector::alpha, 1e-3f, 1, "", "microfacet width"},
             {"f0", &RetroReflector::f0, 0, 1, "", "Fresnel reflectance at normal incidence"}}};
  }
};

}  // namespace reflectree
