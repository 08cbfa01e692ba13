// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree {

// Directions closer to the horizon than this (89.9996 degrees) get "no sample".
inline constexpr float min_cos_theta_o = 0x1p-17f;

// a(wo) by linear interpolation; 0 outside the table.
float albedo_at(const AlbedoTable& table, float cos_theta_o);

}  // namespace reflectree
