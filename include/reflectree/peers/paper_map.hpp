// SPDX-License-Identifier: Apache-2.0
// From the unit disk of the paper's trees to directions wi, and the paper's future work: other maps. What a
// tree holds is T, the target per area of the disk: T = t cos_i d(solid angle) / d(area).
//   disk         orthographic, the paper's: T = t
//   equal_area   Lambert's: T = 2 t cos_i, bounded where t alone is not
//   half_vector  Lambert's for wh, then wi = reflect(wo, wh): T = 8 (wo.wh) t cos_i; a lobe stays where it is
//                when wo moves
#pragma once

#include <optional>

#include "reflectree/math/square_maps.hpp"

namespace reflectree {

enum class PaperMap : std::uint8_t { disk, equal_area, half_vector };

// d(solid angle of wi) / d(area of the disk).
inline double solid_angle_per_area(PaperMap map, Direction wo, Direction wi) {
  if (map == PaperMap::disk) return 1 / double(wi.z);
  if (map == PaperMap::equal_area) return 2;
  return 8 * double(dot(wo, normalize(wo + wi)));
}

// nullopt: outside of the disk, or below the horizon.
inline std::optional<Direction> direction_at(PaperMap map, Direction wo, double x, double y) {
  if (!(x * x + y * y < 1)) return std::nullopt;
  const Vec2<double> p{x, y};
  Vec3<double> w = map == PaperMap::disk ? disk_to_hemisphere_projected(p) : disk_to_hemisphere_equal_area(p);
  if (map == PaperMap::half_vector) w = reflect(Vec3<double>{wo.x, wo.y, wo.z}, w);
  const Direction wi{float(w.x), float(w.y), float(w.z)};
  return wi.z > 0 ? std::optional(wi) : std::nullopt;
}

// Where the place on the disk that gives wi for wo lies for another wo; perhaps below the horizon.
inline Direction carried(PaperMap map, Direction wo, Direction wi, Direction other_wo) {
  if (map != PaperMap::half_vector || wo == other_wo) return wi;
  return reflect(other_wo, normalize(wo + wi));
}

}  // namespace reflectree
