// SPDX-License-Identifier: Apache-2.0
// The domain of a tree: a map from a square to the directions wi, for a known wo.
// Square coordinates are polar: x in [-1, 1] turns the azimuth, |phi| = pi/2 (1 - x), and |y| in [0, 1] goes
// from the pole to the rim, so that a lobe about the pole is refined along y alone. y has the sign of the
// azimuth, or is folded (symmetry.hpp).
//
//   projected_disk  y = sin^2 theta_i, equal steps of projected solid angle: T = t (the paper's measure)
//   equal_area      y = 1 - cos theta_i, equal steps of solid angle: T = t cos_i
//   half_vector     polar in wh, then wi = reflect(wo, wh): T = t cos_i 4 (wo.wh) times y
//   back_vector     the same with wo mirrored about the normal: retro-reflective lobes stay put
//   stretched       cos theta_i = (1 - y)^(1/(2-a)): for f ~ cos_i^-a, 1 < a < 2
//   mirror_vector   polar about the mirror direction of wo, wi itself: round lobes and rings about it stay put
//   normal_vector   the same about the normal: what stands there, however sharp
//   slope_star      half vectors by their slopes in the frame of the surface, stretched by s along x and 1/s
//                   along y: the elliptic lobes of anisotropic microfacets are round and stay put for every wo
//   scaled_star     the same for families, stretched by two widths that follow the parameters: lobes of every
//                   width fill the same part of the square
#pragma once

#include <cstdint>

#include "reflectree/sampler/square/symmetry.hpp"

namespace reflectree {

enum class DomainKind : std::uint8_t {
  projected_disk,
  equal_area,
  half_vector,
  back_vector,
  stretched,
  mirror_vector,
  normal_vector,
  slope_star,
  scaled_star
};

struct Domain {
  DomainKind kind = DomainKind::half_vector;
  Symmetry symmetry = Symmetry::mirror;
  float exponent = 0;              // a, for DomainKind::stretched
  float stretch = 1;               // s, for DomainKind::slope_star
  float scale_x = 1, scale_y = 1;  // for DomainKind::scaled_star: of one member
  // Whether it is a map in the frame of the surface, so that wo may have a y; all others of half vectors and
  // about directions need wo in the x-z plane.
  constexpr bool follows_surface() const {
    return kind == DomainKind::slope_star || kind == DomainKind::scaled_star ||
           kind == DomainKind::projected_disk || kind == DomainKind::equal_area ||
           kind == DomainKind::stretched;
  }
  // Whether the square is half of one, y in [0, 1].
  constexpr bool half() const { return symmetry == Symmetry::mirror; }
  friend bool operator==(const Domain&, const Domain&) = default;
};

const char* name_of(DomainKind kind);

}  // namespace reflectree
