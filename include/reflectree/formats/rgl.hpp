// SPDX-License-Identifier: Apache-2.0
// Reader of the RGL database's `tensor_file` (.bsdf): isotropic RGB materials.
#pragma once

#include "reflectree/brdf/tables/rgl_table.hpp"
#include "reflectree/formats/bytes.hpp"

namespace reflectree {

inline constexpr std::uint64_t max_rgl_bytes = std::uint64_t(64) << 20U;

// Whether the bytes are a tensor_file of any kind.
bool is_tensor_file(ByteView bytes);

// The numbers of a file. Throws Error for files that are damaged, anisotropic, spectral, or not a material.
// `where` names the file in errors and becomes the material's name.
RglFields read_rgl_fields(ByteView bytes, const std::string& where);

// The same as a BRDF.
RglTable read_rgl(ByteView bytes, const std::string& where);

}  // namespace reflectree
