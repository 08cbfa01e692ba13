// SPDX-License-Identifier: Apache-2.0
// Photon mapping (Jensen 1996), progressive (Hachisuka, Ogaki & Jensen 2008) by averaging independent passes
// (Knaus & Zwicker 2011): each pass has maps of its own and one sample per pixel; its radius follows from
//   r_{i+1}^2 = r_i^2 (i + alpha) / (i + 1)
// (eq. 20 there), so that bias and variance of the mean both go to zero. Where the camera's path first meets
// a surface that is not a delta alone,
//   direct light   by next-event estimation and the surface's own directions, as in path tracing;
//   caustics       from the photons that deltas alone have bent;
//   the rest       gathered: looked up where the surface's own directions lead, beyond deltas.
// Without gathering, caustics and the rest are looked up at once. Lookups blur over the radius, and that is
// their bias; passes are independent, so that the film's standard errors hold, bias apart.
#pragma once

#include "reflectree/render/integrators/integrator.hpp"
#include "reflectree/render/integrators/photon_map.hpp"
#include "reflectree/render/lights/emission.hpp"

namespace reflectree::render {

struct PhotonMaps {
  PhotonMap all, caustic;
};

// Photons of `count` paths from the sources, for the pass of this sample. Throws Cancelled.
std::vector<Photon> trace_photons(const World& world, const Emission& emission, std::size_t count,
                                  std::uint64_t seed, int sample, const Host& host);

class PhotonMapper final : public OneByOne {
 public:
  PhotonMapper(const Scene& scene, Technique technique);
  void prepare(int sample, std::uint64_t seed, const Host& host) override;
  int longest_pass() const override { return 1; }
  Rgb radiance(Point origin, Direction direction, PathBits& u) const override;

  // Of the pass of this sample.
  float radius(int sample) const;

 private:
  Rgb follow(Point origin, Direction direction, int depth, std::uint32_t split, PathBits& u) const;
  Rgb leaving(const PathVertex& at, int depth, std::uint32_t split, PathBits& u) const;
  Rgb beyond(const PathVertex& at, const Scattered& next, int depth, bool competes, PathBits& u) const;
  Rgb gathered(PathVertex at, int depth, PathBits& u) const;
  int edges_left(int depth) const;

  World world_;
  Technique technique_;
  Emission emission_;
  Transport::Photons options_;
  std::size_t count_;
  std::uint32_t split_;
  float first_radius_;
  PhotonMaps maps_;
};

}  // namespace reflectree::render
