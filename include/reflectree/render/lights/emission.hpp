// SPDX-License-Identifier: Apache-2.0
// Light as it leaves its sources: the start of photons' paths. A source is drawn in proportion to its power;
// what lies infinitely far away sends light through the disk that the scene's sphere fills from there.
#pragma once

#include "reflectree/render/world.hpp"

namespace reflectree::render {

struct Emitted {
  Point at;
  Direction direction;
  Rgb power;    // divided by the probability of being drawn
  bool inside;  // the scene; else it begins outside, at a distance
};

class Emission {
 public:
  explicit Emission(const Scene& scene);  // holds a reference
  std::optional<Emitted> sample(PathBits& u) const;
  bool dark() const { return sources_.empty(); }
  // The sphere that holds every shape.
  Point centre() const { return centre_; }
  float reach() const { return reach_; }

 private:
  struct Source {
    enum class Kind {
      triangle,
      sphere,
      rectangle,
      disk,
      cylinder,
      point,
      spot,
      directional,
      environment
    } kind;
    std::uint32_t index;
  };
  void enclose();
  void add(Source::Kind kind, std::size_t index, Rgb power);
  Emitted from_far(Direction direction, Rgb irradiance, PathBits& u) const;

  const Scene& scene_;
  Point centre_{};
  float reach_ = 0;
  std::vector<Source> sources_;
  std::vector<double> cdf_;
};

}  // namespace reflectree::render
