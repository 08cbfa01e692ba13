// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/material/description.hpp"

namespace reflectree {

// f = rho / pi. Lambert 1760.
struct Lambert {
  Rgb rho{0.5f, 0.5f, 0.5f};

  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>&) const {
    return T(1) / pi_v<T> * as_rgb<T>(rho);
  }

  BrdfTraits traits() const { return model_traits(*this); }
  static ModelDescription<Lambert> describe() {
    return {"lambert",
            ModelClass::physical,
            "ideal diffuse reflection",
            "Lambert 1760, Photometria",
            {{"rho", &Lambert::rho, 0, 1, "", "albedo"}}};
  }
};

}  // namespace reflectree
