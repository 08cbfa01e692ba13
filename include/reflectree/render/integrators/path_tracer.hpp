// SPDX-License-Identifier: Apache-2.0
// Path tracing with next-event estimation (Kajiya 1986), combined with the surface's own directions by the
// balance or power heuristic (Veach 1997, 9.2.2). Many paths go on together, bounce by bounce: their rays are
// traced in packets, and what one material is asked about all that met it is asked at once (Laine, Karras &
// Aila 2013, "Megakernels Considered Harmful").
#pragma once

#include "reflectree/render/integrators/integrator.hpp"

namespace reflectree::render {

class PathTracer final : public Integrator {
 public:
  explicit PathTracer(const Scene& scene, Technique technique = Technique::balance);
  void radiance(std::span<CameraRay> rays, std::span<Rgb> out) const override;

 private:
  struct Wave;
  void meet(Wave& wave, int depth) const;
  void light(Wave& wave, int depth) const;
  void scatter(Wave& wave, int depth) const;

  World world_;
  Technique technique_;
  std::vector<std::uint32_t> group_;  // of each surface: those with one material are together
  std::size_t groups_;
};

}  // namespace reflectree::render
