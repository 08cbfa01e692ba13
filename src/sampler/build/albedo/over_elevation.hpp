// SPDX-License-Identifier: Apache-2.0
// The albedo over theta_o: panels between the elevations where the function bends, refined until they are smooth.
#pragma once

#include "build/field.hpp"

namespace reflectree::detail {

// The table at one azimuth of the viewer, of one member. checked: by another cubature, at random places.
AlbedoTable albedo_over_elevation(const Field& field, float phi_o, const Coordinates& at,
                                  float relative_error, const Jumps& jumps, std::uint64_t seed,
                                  const Host& host, Effort& effort, std::uint64_t budget, bool checked);

}  // namespace reflectree::detail
