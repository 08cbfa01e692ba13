// SPDX-License-Identifier: Apache-2.0
// What the materials share: the cosine lobe, and the ground of plastics.
#pragma once

#include <cmath>

#include "reflectree/math/fast_functions.hpp"
#include "reflectree/render/integrators/path_bits.hpp"
#include "reflectree/render/materials/scattering.hpp"

namespace reflectree::render {

inline float cosine_pdf(Direction wi) { return wi.z > 0 ? wi.z / reflectree::pi : 0; }

inline Direction cosine_direction(float u1, float u2) {
  const float r = std::sqrt(u1);
  const auto [x, y] = on_circle(u2);
  return {r * x, r * y, std::sqrt(1 - u1)};
}
inline Direction cosine_direction(PathBits& u) {
  const float u1 = to_unit_float(u());
  return cosine_direction(u1, to_unit_float(u()));
}

// rho / (1 - rho F), or rho / (1 - F): what leaves a Lambertian ground under an interface that reflects F.
inline Rgb ground(Rgb rho, float inside, bool nonlinear) {
  const auto one = [&](float v) { return v / (1 - (nonlinear ? v * inside : inside)); };
  return {one(rho.r), one(rho.g), one(rho.b)};
}

inline Scattering::Asks asks_for(const Texture& texture) {
  return texture.attribute >= 0 ? Scattering::Asks::detail : Scattering::Asks::nothing;
}

// How much of a plastic's light the interface is expected to send.
inline float specular_share(const PlasticParameters& p) {
  const Rgb d = mean(p.diffuse), s = mean(p.specular);
  const float diffuse = d.r + d.g + d.b, specular = s.r + s.g + s.b;
  return specular + diffuse > 0 ? specular / (specular + diffuse) : .5f;
}

}  // namespace reflectree::render
