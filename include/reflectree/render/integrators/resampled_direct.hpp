// SPDX-License-Identifier: Apache-2.0
// Direct light by sampling the product of material and light: M directions from the material's own sampler,
// one of them kept in proportion to what it would bring if nothing stood in the way, one shadow ray (Burke,
// Ghosh & Heidrich 2005; Talbot, Cline & Egbert 2005). With candidates w_j of weight f cos / p, and
// q_j = |weight_j L(w_j)|, the estimate  weight_k L(w_k) V(w_k) / q_k * (1 / M) sum q_j  is unbiased for
// every M and needs no density. Lights without extent are sampled as ever.
#pragma once

#include "reflectree/render/integrators/integrator.hpp"

namespace reflectree::render {

class ResampledDirect final : public OneByOne {
 public:
  // Throws Error for more candidates than max_split.
  ResampledDirect(const Scene& scene, int candidates);
  Rgb radiance(Point origin, Direction direction, PathBits& u) const override;

 private:
  struct Arriving {
    Rgb radiance;
    float distance;
  };
  // Light from a direction where only lamps and the sky exist.
  Arriving unshadowed(Point at, Direction direction) const;
  Rgb reflected(const PathVertex& at, PathBits& u) const;

  World world_;
  Scene lamps_;
  std::optional<EmbreeScene> lamps_embree_;
  std::size_t candidates_;
};

}  // namespace reflectree::render
