// SPDX-License-Identifier: Apache-2.0
// What a file of materials is, by its content.
#pragma once

#include <string>

#include "reflectree/brdf/tables/half_angle_table.hpp"
#include "reflectree/formats/bytes.hpp"

namespace reflectree::detail {

enum class MaterialKind { rgl, merl, table };

// Throws Error, which names what the file is instead.
MaterialKind material_kind(ByteView bytes, const std::string& path);

// Throws Error for the member of a file that has none.
void refuse_member(const std::string& path, const std::string& member);

// The look-up that the member of a MERL file names. Throws Error for others.
TableLookup lookup_of(const std::string& path, const std::string& member);

}  // namespace reflectree::detail
