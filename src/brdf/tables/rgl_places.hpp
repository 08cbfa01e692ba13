// SPDX-License-Identifier: Apache-2.0
// Places in the squares of RGL tables over boxes of directions.
#pragma once

#include <array>

#include "enclosed_angles.hpp"
#include "reflectree/math/affine_grid.hpp"
#include "rgl_slices.hpp"

namespace reflectree::rgl_places {

using namespace enclosed_angles;

inline constexpr double u = 0x1p-24;

inline AffineForm elevation_to_u(const AffineForm& theta) { return sqrt(theta * AffineForm(2.f / pi)); }
inline AffineForm azimuth_to_v(const AffineForm& phi) {
  return phi * AffineForm(0.5f / pi) + AffineForm(0.5f);
}
// A position on a grid over [0, 1], in cells.
inline AffineForm located(const AffineForm& x, int nodes) {
  return within(within(x, 0, 1) * AffineForm(float(nodes - 1)), 0, nodes - 1);
}

// The azimuth of wh relative to that of wo. In the plane of wo y = 0 the sign of wh.y is that of wi.y, and no map
// returns wi.y = 0 beyond the pole (the cosine of cos_sin_half is positive).
inline AffineForm relative_azimuth(const ShadingGeometry<AffineForm>& g) {
  const bool plane = g.wo.y.range.magnitude() == 0;
  if (const HalfAzimuth* known = known_azimuth(g)) return known->angle;
  AffineForm y = g.wh.y, x = g.wh.x;
  if (!plane) y = g.wo.x * g.wh.y - g.wo.y * g.wh.x, x = g.wo.x * g.wh.x + g.wo.y * g.wh.y;
  if (plane && g.wi.y.range.lo >= 0) return between_azimuths(angle_above(within(y, 0, 2), x), g);
  if (plane && g.wi.y.range.hi <= 0) return between_azimuths(-angle_above(within(-y, 0, 2), x), g);
  if (x.range.lo > 0) return atan2(y, x);
  return AffineForm::anything_in({-pi_v<double>, pi_v<double>});
}

// A table that is linear between nodes, at a place of the square.
inline AffineForm interpolated(const SquareNodes& table, const AffineForm& of_u, const AffineForm& of_v) {
  const GridSize size = table.size;
  if (size.height > 1) {
    const GridPieces<2, 100> pieces({GridAxis{size.width}, GridAxis{size.height}},
                                    {located(of_u, size.width), located(of_v, size.height)});
    return pieces.interpolated_or_ranged(
        [&](const std::array<int, 2>& i) { return table.values[i[1] * size.width + i[0]]; }, 16 * u);
  }
  const GridPieces<1> pieces({GridAxis{size.width}}, {located(of_u, size.width)});
  const auto value = [&](const std::array<int, 1>& i) { return table.values[i[0]]; };
  if (pieces.are_few()) return pieces.interpolated(value, 8 * u);
  RealInterval range{detail::infinity, -detail::infinity};
  for (int i = pieces.first()[0]; i <= pieces.last()[0]; ++i) {
    const auto v = double(table.values[i]);
    range = hull(range, RealInterval(v, v));
  }
  return widened(AffineForm::anything_in(range), 8 * u);
}

}  // namespace reflectree::rgl_places
