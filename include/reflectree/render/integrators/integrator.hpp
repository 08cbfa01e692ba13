// SPDX-License-Identifier: Apache-2.0
// Light along a camera ray, by one of several ways to compute it; film.hpp makes pictures of it.
#pragma once

#include <memory>

#include "reflectree/render/world.hpp"

namespace reflectree::render {

// A camera ray, with its sample's random bits.
struct CameraRay {
  Point origin;
  Direction direction;
  PathBits bits;
};

class Integrator {
 public:
  virtual ~Integrator() = default;
  // The radiance that arrives along each, an estimate from its own bits alone; the bits are used up.
  virtual void radiance(std::span<CameraRay> rays, std::span<Rgb> out) const = 0;
  // Called before each pass over the picture, of at most longest_pass() samples per pixel from `sample` on:
  // where a sample's share of the work is common to all pixels (photons). Throws Cancelled.
  virtual void prepare(int /*sample*/, std::uint64_t /*seed*/, const Host& /*host*/) {}
  virtual int longest_pass() const { return 8; }
};

// One that takes them one after the other.
class OneByOne : public Integrator {
 public:
  void radiance(std::span<CameraRay> rays, std::span<Rgb> out) const final {
    for (std::size_t i = 0; i < rays.size(); ++i)
      out[i] = radiance(rays[i].origin, rays[i].direction, rays[i].bits);
  }

 protected:
  virtual Rgb radiance(Point origin, Direction direction, PathBits& u) const = 0;
};

// By scene.transport. Holds a reference to the scene. Throws Error for a technique that it does not know.
std::unique_ptr<Integrator> make_integrator(const Scene& scene, Technique technique);

}  // namespace reflectree::render
