// SPDX-License-Identifier: Apache-2.0
// Reader of Zemax's .bsdf text: the reflection of one wavelength, or of the three tristimulus curves,
// isotropic or for several rotations of the sample. What the format leaves open:
// docs/decisions/0040-zemax.md.
#pragma once

#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/tables/specular_table.hpp"
#include "reflectree/formats/bytes.hpp"
#include "reflectree/formats/measured_facts.hpp"

namespace reflectree {

inline constexpr std::uint64_t max_zemax_bytes = std::uint64_t(64) << 20U;

// Whether the text begins as such a file does; not whether it reflects.
bool is_zemax_file(ByteView bytes);

// Of one wavelength: "held" and "zeros"; of three curves "rgb", "x", "y" and "z", and each again with
// "-zeros". The first is the default.
std::vector<std::string> zemax_members(ByteView bytes, const std::string& path);

// A SpecularTable<float>, or <Rgb> for "rgb". Throws Error with the line of what is damaged.
AnyBrdf read_zemax(ByteView bytes, const std::string& path, const std::string& member);

MeasuredFacts zemax_facts(ByteView bytes, const std::string& path, const std::string& member);

}  // namespace reflectree
