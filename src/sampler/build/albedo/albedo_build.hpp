// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "build/field.hpp"

namespace reflectree::detail {

// The albedo over theta_o, checked between its nodes by integrals of another kind. Takes a third of the
// effort at most, as far as it can: the table states a larger error then.
AlbedoTable build_albedo(const Field& field, float relative_error, const Jumps& jumps, std::uint64_t seed,
                         const Host& host, Effort& effort);

}  // namespace reflectree::detail
