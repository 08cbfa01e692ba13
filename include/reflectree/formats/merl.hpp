// SPDX-License-Identifier: Apache-2.0
// Reader and writer of MERL .binary files: 90 x 90 x 180 cells, and the non-reciprocal variant with 360.
#pragma once

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/tables/half_angle_table.hpp"
#include "reflectree/formats/bytes.hpp"
#include "reflectree/host.hpp"

namespace reflectree {

inline constexpr std::uint64_t max_merl_bytes = 69'984'012;

// Whether the bytes begin with the dimensions of a MERL file.
bool is_merl_file(ByteView bytes);

// Throws Error for files that are damaged. `where` names the file in errors and becomes the table's name.
// Entries that were not measured are negative in the file and here; HalfAngleTable says what they count for.
HalfAngleTable read_merl(ByteView bytes, const std::string& where, TableLookup lookup = TableLookup::nearest);

// Tabulates an isotropic BRDF of 1 or 3 channels with MERL's cells, each at cell_centre(). A reciprocal
// table holds the mean of f(wo, wi) and f(wi, wo). Throws Error for functions that MERL cannot hold or that
// return negative or non-finite values; Cancelled when the host says so.
HalfAngleTable tabulate_merl(const AnyBrdf& f, bool reciprocal = true, const Host& host = {});

// The bytes of a file that read_merl() reads back within a float's rounding. The table has MERL's cells.
Bytes write_merl(const HalfAngleTable& table);

}  // namespace reflectree
