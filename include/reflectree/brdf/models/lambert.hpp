// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/shading_geometry.hpp"
#include "reflectree/brdf/value.hpp"

namespace reflectree {

// f = rho / pi. Lambert 1760.
struct Lambert {
  Rgb rho{0.5f, 0.5f, 0.5f};
  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>&) const {
    return T(1) / pi_v<T> * lift<T>(rho);
  }
};

}  // namespace reflectree
