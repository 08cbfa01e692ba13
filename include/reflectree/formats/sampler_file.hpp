// SPDX-License-Identifier: Apache-2.0
// Sampler files, version 1. Little-endian; made to be read for ever.
//
//   file  = magic[8] chunk... crc32         crc32 (IEEE 802.3) of everything before it
//   chunk = tag[4] version:u16 flags:u16 length:u64 payload[length]
//
//   MATL  text of the material
//   TARG  kind:u8 index:u16                         DOMN  kind:u8 symmetry:u8 exponent:f32
//   EXPA  ONPA  the partitions: coordinates (name lo hi)..., axis:u8..., split:f32...
//   EXTR  exact trees: status:u8 volume:f32 tree    ONTR  one-shot trees: tree
//         tree = nodes (2 bits each) mass:u32... slope_x:i8... slope_y:i8...
//   ALBD  relative_error:f32 cos_theta_o:f32... albedo:f32...
//   PROB  64 probes of the BRDF's target: f32...
//   REPT* trials:f32 overshoot:f32 variance:f32 asymmetry:f32 evaluations:u64, what the builder measured
// Where there is something to say:
//   ANIS  of anisotropic functions: symmetry:u8 axis:f32 stretch:f32 phi_o:f32... (albedos row by row)
//   SCAL  target.scale:f32, unless it is 1
//   FMLY  of families: (name lo:f32 hi:f32 logarithmic:u8 axis of the albedo: lo:f32 hi:f32 rows:u32)...,
//         the law of the widths x:f32[3] y:f32[3] (albedos: the last parameter outermost)
//   WDTH  of a member cut out of a family: the widths of its domain, x:f32 y:f32
//   PRCH* every channel at the 64 probes: f32..., of functions without a name
//   CERT* of every exact tree the largest ratio of a proved bound to the best value seen: f32...
//   NOTE* sentences about what was promised and is not kept
//
// *: flag bit 0 marks a chunk that a reader who does not know its tag or version may skip. Lists and texts
// carry their length as u32. The BRDF itself is not inside: load it by the material's text and check_identity().
#pragma once

#include "reflectree/formats/bytes.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree {

inline constexpr std::uint64_t max_sampler_bytes = std::uint64_t(256) << 20U;

// Whether the bytes begin like a sampler file.
bool is_sampler_file(ByteView bytes);

// The same data gives the same bytes everywhere.
Bytes encode_sampler(const SamplerData& data);
// Throws Error for whatever is damaged, of a later version, or not a sampler; the result is valid.
// `where` names the file in errors.
SamplerData decode_sampler(ByteView bytes, const std::string& where);

// The same with files; a file is written whole or not at all.
void save_sampler(const std::string& path, const SamplerData& data);
SamplerData load_sampler(const std::string& path);

}  // namespace reflectree
