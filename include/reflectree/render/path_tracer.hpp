// SPDX-License-Identifier: Apache-2.0
// Path tracing with next-event estimation (Kajiya 1986), combined by the balance heuristic (Veach
// 1997, 9.2.2).
#pragma once

#include "reflectree/io/image.hpp"
#include "reflectree/render/scene.hpp"

namespace reflectree::render {

struct RenderOptions {
  int samples = 0;  // a pixel; 0: the scene's
  std::uint64_t seed = 1;
};

// Channels R, G, B and stderr.R, stderr.G, stderr.B, the standard error of each pixel's mean. A sample's
// random numbers depend on seed, pixel and sample alone: the picture is the same for any number of threads.
// Throws Cancelled.
Image render(const Scene& scene, const RenderOptions& options = {}, const Host& host = {});

}  // namespace reflectree::render
