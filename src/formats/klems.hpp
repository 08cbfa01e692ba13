// SPDX-License-Identifier: Apache-2.0
// Reader of the Klems matrices in WINDOW's and Radiance's BSDF XML: reflection, front and back, at each
// wavelength of the file. Conventions: docs/decisions/0041-klems.md.
#pragma once

#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/formats/bytes.hpp"
#include "reflectree/formats/measured_facts.hpp"

namespace reflectree {

inline constexpr std::uint64_t max_klems_bytes = std::uint64_t(64) << 20U;

// Whether the bytes are such an XML file, be it of matrices or of a tensor tree.
bool is_window_xml(ByteView bytes);

// "front" and "back" of the visible light, or of the file's first wavelength where there is none, as far as
// they are there; then "solar-front" and so on. The first is the default.
std::vector<std::string> klems_members(ByteView bytes, const std::string& path);

// A KlemsTable. Throws Error with the line of what is damaged, and for tensor trees.
AnyBrdf read_klems(ByteView bytes, const std::string& path, const std::string& member);

MeasuredFacts klems_facts(ByteView bytes, const std::string& path, const std::string& member);

}  // namespace reflectree
