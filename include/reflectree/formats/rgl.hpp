// SPDX-License-Identifier: Apache-2.0
// Reader of the RGL database's `tensor_file` (.bsdf): isotropic and anisotropic, RGB and spectral materials.
#pragma once

#include "reflectree/brdf/tables/rgl_table.hpp"
#include "reflectree/brdf/tables/rgl_wide_table.hpp"
#include "reflectree/formats/bytes.hpp"

namespace reflectree {

inline constexpr std::uint64_t max_rgl_bytes = std::uint64_t(512) << 20U;

// Whether the bytes are a tensor_file of any kind.
bool is_tensor_file(ByteView bytes);

// All that follows throws Error for files that are damaged or not a material. `where` names the file in
// errors and becomes the material's name.

// The numbers of an isotropic RGB file; an Error for others.
RglFields read_rgl_fields(ByteView bytes, const std::string& where);

// The same as a BRDF.
RglTable read_rgl(ByteView bytes, const std::string& where);

// What kind of file it is.
struct RglLayout {
  std::uint64_t azimuths = 1;      // of the known direction
  std::vector<float> wavelengths;  // nm, ascending; empty: RGB
  bool is_isotropic_rgb() const { return azimuths == 1 && wavelengths.empty(); }
};
RglLayout rgl_layout(ByteView bytes, const std::string& where);

// The numbers of any file. The channels of a spectral one are its wavelengths; or, if `as_rgb` or where there
// are more than max_channels, linear RGB by the CIE 1931 observer under D65.
RglWideFields read_rgl_wide_fields(ByteView bytes, const std::string& where, bool as_rgb = false);

}  // namespace reflectree
