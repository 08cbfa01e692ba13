// SPDX-License-Identifier: Apache-2.0
// The albedo over boxes of viewers, as samplers look it up.
#pragma once

#include <array>

#include "reflectree/math/affine_form.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

AffineForm albedo_over(const PackedAlbedo& table, const AffineForm& cosine);
// phi_o and the coordinates of parameters as floats have them; those that the table does not know do not matter.
AffineForm albedo_over(const PackedAlbedo& table, const AffineForm& cosine, const AffineForm& phi_o,
                       const std::array<AffineForm, max_parameters>& at);

}  // namespace reflectree::detail
