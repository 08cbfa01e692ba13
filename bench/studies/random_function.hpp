// SPDX-License-Identifier: Apache-2.0
// Functions by seeds, whose albedo is known in closed form up to one smooth integral: a matt ground and up to four
// lobes, smooth or with an edge, which stand still or move with the viewer.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reflectree/math/direction.hpp"

namespace reflectree::study {

struct RandomLobe {
  enum class Place { fixed, mirror, back } place;
  bool disc;            // constant up to `width` from the centre, not exp(-d^2 / width^2)
  float theta, phi;     // fixed: the place, with wo at azimuth 0; mirrored at the plane of incidence
  float width, height;  // width: a chord
  Direction centre(Direction wo, int side) const;
  // At wi, both mirror images together.
  float operator()(Direction wo, Direction wi) const;
  // Its part of the albedo: the integral of it times cos theta_i over the hemisphere.
  double albedo(Direction wo) const;
};

struct RandomFunction {
  float ground;
  std::vector<RandomLobe> lobes;
  float operator()(Direction wo, Direction wi) const;
  double albedo(Direction wo) const;
  std::string words() const;
};

RandomFunction random_function(std::uint64_t seed);

}  // namespace reflectree::study
