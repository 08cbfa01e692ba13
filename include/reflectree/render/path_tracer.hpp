// SPDX-License-Identifier: Apache-2.0
// Path tracing with next-event estimation (Kajiya 1986), combined with the surface's own directions by the
// balance or power heuristic (Veach 1997, 9.2.2).
#pragma once

#include "reflectree/render/integrator.hpp"

namespace reflectree::render {

class PathTracer final : public Integrator {
 public:
  explicit PathTracer(const Scene& scene, Technique technique = Technique::balance)
      : world_(scene), technique_(technique) {}
  Rgb radiance(Point origin, Direction direction, PathBits& u) const override;

 private:
  World world_;
  Technique technique_;
};

}  // namespace reflectree::render
