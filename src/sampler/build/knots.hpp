// SPDX-License-Identifier: Apache-2.0
// Where, in the known coordinates, f is known to leap or to bend: by what it tells, and by what was found.
#pragma once

#include <vector>

#include "field.hpp"

namespace reflectree::detail {

// Borders of theta_o from 0 to theta_max, radians: knots and jumps are among them.
std::vector<float> theta_borders(const Field& field, const Jumps* jumps);
// Every azimuth of which f tells, radians, in the viewer's frame.
std::vector<float> told_azimuths(const Field& field);
// Whether one of them is that at which azimuths go round, so that viewers on both sides of it differ.
bool leaps_at_ends(const Field& field);
// Borders of phi_o in the viewer's frame, from 0 to azimuth_span, for viewers between two elevations.
std::vector<float> azimuth_borders(const Field& field, const Jumps* jumps, float theta_lo, float theta_hi);

}  // namespace reflectree::detail
