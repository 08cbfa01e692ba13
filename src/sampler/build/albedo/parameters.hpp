// SPDX-License-Identifier: Apache-2.0
// The albedo of a family from those of single members.
#pragma once

#include <functional>

#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

// slice_at(coordinate, checked): the table where one parameter stands still, of theta_o and whatever else is
// known; `checked` by other integrals. Slices are computed at twice as many Chebyshev places until the
// polynomial through those there were foretells the new ones, or the effort is spent; the table holds as many
// equidistant rows, read off the polynomial, as cubics between them need.
AlbedoTable albedo_over_parameter(const KnownParameter& parameter, float relative_error,
                                  const std::function<AlbedoTable(float coordinate, bool checked)>& slice_at,
                                  const std::function<bool()>& spent);

}  // namespace reflectree::detail
