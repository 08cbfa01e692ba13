// SPDX-License-Identifier: Apache-2.0
// Light along a camera ray, by one of several ways to compute it; film.hpp makes pictures of it.
#pragma once

#include <memory>

#include "reflectree/render/world.hpp"

namespace reflectree::render {

class Integrator {
 public:
  virtual ~Integrator() = default;
  // The radiance that arrives, an estimate from one sample's random bits.
  virtual Rgb radiance(Point origin, Direction direction, PathBits& u) const = 0;
  // Called before each pass over the picture, of at most longest_pass() samples a pixel from `sample` on:
  // where a sample's share of the work is common to all pixels (photons). Throws Cancelled.
  virtual void prepare(int /*sample*/, std::uint64_t /*seed*/, const Host& /*host*/) {}
  virtual int longest_pass() const { return 8; }
};

// By scene.transport. Holds a reference to the scene. Throws Error for a technique that it does not know.
std::unique_ptr<Integrator> make_integrator(const Scene& scene, Technique technique);

}  // namespace reflectree::render
