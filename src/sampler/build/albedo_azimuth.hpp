// SPDX-License-Identifier: Apache-2.0
// The albedo over the whole hemisphere of viewers from rows over theta_o at a few azimuths.
#pragma once

#include <functional>

#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/known/viewer_frame.hpp"

namespace reflectree::detail {

// row_at(phi_o, checked): the table at one azimuth of the viewer, to a third of the error asked for;
// `checked` by other integrals: later rows are checked by what the earlier ones foretell. Rows are computed
// at twice as many azimuths until the series through those there were foretell the new ones, or the effort is
// spent; the table holds as many rows, read off the series, as cubics between them need.
AlbedoTable albedo_over_azimuth(ViewerSymmetry symmetry, float relative_error,
                                const std::function<AlbedoTable(float phi_o, bool checked)>& row_at,
                                const std::function<bool()>& spent);

}  // namespace reflectree::detail
