// SPDX-License-Identifier: Apache-2.0
// Path tracing with next-event estimation (Kajiya 1986), combined by the balance or power heuristic (Veach
// 1997, 9.2.2). Radiance along one ray; film.hpp makes pictures of it.
#pragma once

#include "reflectree/render/lights.hpp"

namespace reflectree::render {

enum class Technique {
  balance,  // lights and the surface's own directions, weighed by the balance heuristic
  power,    // by the power heuristic, exponent 2
  light,    // lights alone; deltas still find them by chance
  surface   // the surface's directions alone; point and directional lights stay dark
};

class PathTracer {
 public:
  explicit PathTracer(const Scene& scene, Technique technique = Technique::balance);
  Rgb radiance(Point origin, Direction direction, Pcg32& u) const;

 private:
  float weight(float own, float other) const;
  float near(Point at) const;
  Rgb direct(const Interaction& on, const Frame<float>& frame, Direction wo, const Scattering& surface,
             Pcg32& u) const;

  const Scene& scene_;
  Technique technique_;
  EmbreeScene embree_;
  Lights lights_;
  float extent_ = 0;
};

}  // namespace reflectree::render
