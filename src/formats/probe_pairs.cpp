// SPDX-License-Identifier: Apache-2.0
#include "probe_pairs.hpp"

namespace reflectree {
namespace {

Direction uniform_direction(Pcg32& random) {
  const float z = 1 - to_unit_float(random()), phi = 2 * pi * to_unit_float(random());
  const float r = sqrt(max(1 - z * z, 0.f));
  return {r * cos(phi), r * sin(phi), z};
}

}  // namespace

RandomPair next_pair(Pcg32& random, std::uint64_t number) {
  for (;;) {
    const Direction wo = uniform_direction(random);
    Direction wi = uniform_direction(random);
    if (number % 2 == 0) {
      const float x = to_unit_float(random()) - 0.5f, y = to_unit_float(random()) - 0.5f;
      wi = reflect(wo, normalize(Direction{0.5f * x, 0.5f * y, 1}));
    }
    if (!(wi.z > 0)) continue;
    const double elevation_deg = std::acos(double(min(wo.z, wi.z))) * 180 / pi_v<double>;
    std::size_t band = 0;
    while (band + 2 < MeasuredFacts::bands_deg.size() && elevation_deg >= MeasuredFacts::bands_deg[band + 1])
      ++band;
    return {shading_geometry(wo, wi), band};
  }
}

}  // namespace reflectree
