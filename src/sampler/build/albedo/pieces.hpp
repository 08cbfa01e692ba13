// SPDX-License-Identifier: Apache-2.0
// The albedo of a function that leaps or bends at some azimuths of the viewer, or changes within few degrees.
#pragma once

#include <functional>

#include "rows.hpp"

namespace reflectree::detail {

// From border to border (shares of the span, ascending from 0 to 1; `leaps`: which of them have two sides) pieces
// of polynomials over phi_o, halved until rows foretell each other or the effort is spent; the table states what
// rows then missed.
AlbedoTable albedo_in_pieces(float span, const std::vector<double>& borders, const std::vector<bool>& leaps,
                             double error, const RowAt& row_at, const std::function<bool()>& spent);

}  // namespace reflectree::detail
