// SPDX-License-Identifier: Apache-2.0
// Microfacet distributions of one or two widths with Smith's shadowing, uncorrelated (Walter et al. 2007),
// and their visible normals: GGX by Heitz 2018 (JCGT 7(4)); Beckmann by inverting the distribution of visible
// slopes, Heitz & d'Eon 2014 (eq. 10), along wo (visible_slope.hpp), while the slope across is Gaussian.
#pragma once

#include "reflectree/render/integrators/path_bits.hpp"
#include "reflectree/render/materials/scattering.hpp"

namespace reflectree::render {

class Microfacets {
 public:
  explicit Microfacets(Roughness roughness);

  float d(Direction wh) const;
  float g1(Direction w) const;
  // Density of `sample`, per solid angle of wh, from d(wh) and g1(wo).
  float pdf(Direction wo, Direction wh, float d, float g1_o) const;
  Direction sample(Direction wo, float u1, float u2) const;
  Direction sample(Direction wo, PathBits& u) const {
    const float u1 = to_unit_float(u());
    return sample(wo, u1, to_unit_float(u()));
  }

 private:
  Roughness roughness_;
};

// The share of light from wo that single scattering on a dielectric interface of these normals reflects.
float rough_reflectance(const Microfacets& normals, float cos_theta, float eta, int resolution);
// The share that it refracts; both are less than 1 together by what shadowing takes.
float rough_transmittance(const Microfacets& normals, float cos_theta, float eta, int resolution);

}  // namespace reflectree::render
