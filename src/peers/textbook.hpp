// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/peers/lobe.hpp"

namespace reflectree {

// The samplers published with the models; a sum draws a term by its weight. nullopt: one of the terms has none.
std::optional<LobeMixture> textbook_mixture(const Material& material);
// The same with bounded visible normals; nullopt also where there are none of GGX.
std::optional<LobeMixture> bounded_mixture(const Material& material);

}  // namespace reflectree
