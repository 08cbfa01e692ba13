// SPDX-License-Identifier: Apache-2.0
// The albedo of a SpecularTable without negative entries: linear in the entries, and so known exactly.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "reflectree/brdf/tables/between_nodes.hpp"
#include "reflectree/brdf/tables/specular_table.hpp"
#include "reflectree/math/fast_functions.hpp"

namespace reflectree::detail {

// An angle, with as many turns added as bring it to the first node or beyond, by less than a turn.
inline float wrapped(float angle, float first) {
  const float turns = (angle - first) * (0.5f / pi);
  return first + 2 * pi * (turns - std::floor(turns));
}
// The rotations of the sample beside that of a viewer at azimuth phi.
inline BetweenNodes rotation_of(const SpecularAxes& axes, float cos_phi, float sin_phi) {
  if (axes.rotation.size() < 2) return {};
  return between_nodes(axes.rotation, wrapped(0.5f * pi - angle_of(sin_phi, cos_phi), axes.rotation.front()));
}

/** Of the entries [azimuth][radial] of a slice, what each adds to the integral of f cos_i over the hemisphere
 *  for a viewer at theta_o (radians): the integral of its hat function times cos_i. */
std::vector<double> albedo_shares(const SpecularAxes& axes, double theta_o);

/** The integral of f cos_i for a viewer, in sr^0; values are not negative. Rotations and elevations between
 *  nodes mix the slices. Relative error below 1e-5. */
std::function<double(Direction wo)> specular_albedo(const SpecularAxes& axes,
                                                    const std::vector<float>& values);

}  // namespace reflectree::detail
