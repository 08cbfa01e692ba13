// SPDX-License-Identifier: Apache-2.0
// Fresnel's equations (brdf/models/fresnel.hpp) as the renderer asks for them: from either side, in colours.
#pragma once

#include "reflectree/brdf/value.hpp"

namespace reflectree::render {

struct Dielectric {
  float reflectance;
  float cos_theta_t;  // of the refracted direction, its sign opposite to cos_theta's
  float eta;          // of the far side over the near side
};
// `eta`: below the surface over above it. cos_theta < 0: light comes from below.
Dielectric fresnel(float cos_theta, float eta);
// Light from a vacuum on a metal of index eta + i k.
Rgb fresnel_conductor(float cos_theta, Rgb eta, Rgb k);
// 2 int F(mu) mu dmu: of diffuse light.
float fresnel_diffuse(float eta);

}  // namespace reflectree::render
