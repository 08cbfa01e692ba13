// SPDX-License-Identifier: Apache-2.0
// The albedo over the whole hemisphere of viewers from rows over theta_o at a few azimuths.
#pragma once

#include <functional>

#include "reflectree/sampler/known/viewer_frame.hpp"
#include "rows.hpp"

namespace reflectree::detail {

// borders: where f leaps or bends over phi_o, from 0 to the span, radians; `bends`: where it does not leap, so that
// one row serves both sides; both ends are leaps, too, or not.
// Without any the function is taken for smooth (a series); where that does not hold, and with borders, the
// table is made in pieces. Rows are added until they foretell each other and miss_of(table), the largest
// relative miss at viewers that no row stands at, is what the table states; or the effort is spent, and the
// table states what it misses.
AlbedoTable albedo_over_azimuth(ViewerSymmetry symmetry, const std::vector<float>& borders,
                                const std::vector<float>& bends, bool leaps_at_ends, float relative_error,
                                const RowAt& row_at, const std::function<double(const AlbedoTable&)>& miss_of,
                                const std::function<bool()>& spent);

}  // namespace reflectree::detail
