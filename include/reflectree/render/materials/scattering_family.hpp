// SPDX-License-Identifier: Apache-2.0
// A family of functions whose parameters vary over a surface: each place has its member.
#pragma once

#include <vector>

#include "reflectree/render/materials/scattering.hpp"
#include "reflectree/sampler/family_sampler.hpp"

namespace reflectree::render {

// `at`: numbers or grey pictures, in the order of the family's ranges. Throws Error for a number or a texel
// outside of its range, and for attributes of meshes, whose numbers are not known yet.
ScatteringPtr sampled_family(FamilySampler<AnyFamily> sampler, bool exact, std::vector<Texture> at);

}  // namespace reflectree::render
