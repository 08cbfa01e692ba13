// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "field.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree::detail {

// The albedo a(wo) of the target as a piecewise-linear table, by adaptive cubature over the domain and
// adaptive nodes in cos_theta_o, both to a relative error.
AlbedoTable build_albedo(const Field& field, float relative_error, const Host& host,
                         std::uint64_t* evaluations);

}  // namespace reflectree::detail
