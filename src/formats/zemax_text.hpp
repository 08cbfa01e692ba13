// SPDX-License-Identifier: Apache-2.0
// The text of Zemax's .bsdf as numbers, before anything is made of them.
#pragma once

#include <string>
#include <vector>

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

// Degrees, as in the file. values[curve]: [rotation][incidence][azimuth][radial].
struct ZemaxFile {
  std::vector<double> rotation, incidence, azimuth, radial;
  bool mirrored = false, tristimulus = false;
  std::vector<std::vector<float>> values;

  std::size_t size() const { return rotation.size() * incidence.size() * azimuth.size() * radial.size(); }
};
inline constexpr double zemax_same_angle = 1e-3;  // degrees

// Throws Error with the line of what is damaged.
ZemaxFile parse_zemax(ByteView bytes, const std::string& path);

}  // namespace reflectree
