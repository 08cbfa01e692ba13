// SPDX-License-Identifier: Apache-2.0
// Recursive (distribution) ray tracing (Cook, Porter & Carpenter 1984): a ray that meets a surface sends
// `split` rays on, drawn together by the material's sample_n, and as many to lights; each of those sends a
// quarter as many, and so on down to one. Surfaces with deltas alone send one ray and keep the number
// for the next.
#pragma once

#include "reflectree/render/integrators/integrator.hpp"

namespace reflectree::render {

class RecursiveTracer final : public OneByOne {
 public:
  // `max_depth` counts path edges; -1: no limit. Throws Error for a split beyond max_split.
  RecursiveTracer(const Scene& scene, Technique technique, int split, int max_depth);
  Rgb radiance(Point origin, Direction direction, PathBits& u) const override;

 private:
  struct Ray {
    Point origin;
    Direction direction;
    Rgb throughput;   // of its path; what Russian roulette looks at
    float drawn_pdf;  // of the direction; 0: nothing competes with it
    int depth;
    std::size_t split;
  };
  Rgb arriving(const Ray& ray, PathBits& u) const;
  Rgb leaving_split(const PathVertex& at, const Ray& ray, PathBits& u) const;
  Rgb leaving(const PathVertex& at, const Ray& ray, std::span<PathBits> u, std::span<Scattered> next) const;

  World world_;
  Technique technique_;
  std::size_t split_;
  int max_depth_;
};

}  // namespace reflectree::render
