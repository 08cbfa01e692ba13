// SPDX-License-Identifier: Apache-2.0
// From words to a BRDF: a material's text, its files read where they lie.
#pragma once

#include <string>

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/formats/bytes.hpp"
#include "reflectree/formats/file_places.hpp"

namespace reflectree {

struct SamplerData;

// Whether the text names a sampler file; what else it is, parsing tells.
bool names_sampler_file(const std::string& text, const FilePlaces& places);

// Material text, or the path of a file of one material. Throws Error.
Material parse_material(const std::string& text, const FilePlaces& places);
// The bytes of a file that a material names. Throws Error.
Bytes read_material_file(const std::string& path, const FilePlaces& places);
// The BRDF of a material whose files lie there. Throws Error.
AnyBrdf make_brdf(const Material& material, const FilePlaces& places);

// The BRDF that a sampler was built of. Throws Error where they do not belong together.
AnyBrdf brdf_of(const SamplerData& sampler, const FilePlaces& places);

// The BRDF of a material's text, or that of a sampler file. Throws Error.
AnyBrdf open_brdf(const std::string& text, const FilePlaces& places = {});

}  // namespace reflectree
