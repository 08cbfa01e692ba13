// SPDX-License-Identifier: Apache-2.0
// Photons where light has met surfaces, found within a radius: a hash grid whose cells are two radii wide,
// sorted by bucket. Plain data but for the grid.
#pragma once

#include <vector>

#include "reflectree/render/world.hpp"

namespace reflectree::render {

struct Photon {
  Point at;
  Direction wi;  // in the world; towards where it came from
  Rgb etendue;   // its power over its cosine about the true normal: radiance times area and solid angle
  std::uint16_t edges = 1;  // of its path so far
  bool caustic = false;     // every surface on its path, at least one, has bent it by a delta
};

class PhotonMap {
 public:
  PhotonMap() = default;
  PhotonMap(std::vector<Photon> photons, float radius);

  std::size_t size() const { return photons_.size(); }
  // Radiance that `at` reflects, from photons whose paths have `fewest` to `most` edges: their f |cos| about
  // the shading normal times their etendue, by the kernel 2 / (pi r^2) (1 - d^2 / r^2) of the disk
  // (Silverman 1986, 4.2).
  Rgb reflected(const PathVertex& at, int fewest, int most) const;

 private:
  // Calls visit(photon, squared distance / radius^2) for each within the radius.
  template <class Visit>
  void near(Point at, const Visit& visit) const;

  struct Cell {
    std::int32_t x, y, z;
    friend bool operator==(const Cell&, const Cell&) = default;
  };
  Cell cell_of(Point at, float shift) const;
  std::size_t bucket_of(Cell cell) const;

  std::vector<Photon> photons_;       // by bucket
  std::vector<std::uint32_t> first_;  // of each bucket, and one more
  float radius_ = 0;
};

}  // namespace reflectree::render
