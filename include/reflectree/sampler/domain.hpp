// SPDX-License-Identifier: Apache-2.0
// The domain of a tree: a map from a square to the directions wi, for a known wo in the x-z plane.
//   projected_disk  square -> disk -> hemisphere by projection: T = t (the paper's)
//   equal_area      square -> disk -> hemisphere, area-preserving: T = t cos_i
//   half_vector     the same map for wh, then wi = reflect(wo, wh): T = t cos_i 4 (wo.wh)
//   back_vector     the same with wo mirrored about the normal: retro-reflective lobes stay put
//   stretched       square -> hemisphere with cos_i = v^(1/(2-a)): for f ~ cos_i^-a, 1 < a < 2
// Square coordinates: x in [-1, 1]; y in [-1, 1], or, for mirror-symmetric functions, in [0, 1] with a
// coin for the sign of wi.y.
#pragma once

#include <cstdint>

namespace reflectree {

enum class DomainKind : std::uint8_t { projected_disk, equal_area, half_vector, back_vector, stretched };

struct Domain {
  DomainKind kind = DomainKind::half_vector;
  bool half = true;    // mirror-symmetric: y in [0, 1]
  float exponent = 0;  // a, for DomainKind::stretched
  friend bool operator==(const Domain&, const Domain&) = default;
};

const char* name_of(DomainKind kind);

}  // namespace reflectree
