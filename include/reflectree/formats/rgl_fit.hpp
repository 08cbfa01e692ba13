// SPDX-License-Identifier: Apache-2.0
// Any BRDF as an RGL `tensor_file`, isotropic or not: the fit of the tables of Dupuy and Jakob 2018, and the
// bytes of a file. How the tables are found: docs/decisions/0044-bake-rgl.md.
#pragma once

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/tables/rgl_wide_table.hpp"
#include "reflectree/formats/bytes.hpp"
#include "reflectree/host.hpp"

namespace reflectree {

// Nodes of the tables. Of files in the database: 8, 128, 32.
struct RglFitOptions {
  int elevations = 16;  // of wo, from 0 to 90 degrees
  int azimuths = 9;     // of wo in a quarter of a turn; isotropic functions need none
  int normals = 128;    // per side of the tables over half vectors
  int colours = 32;     // per side of the tables of colours
};

struct RglFit {
  RglWideFields fields;          // RGB
  std::vector<float> luminance;  // [phi_o][theta_o][y][x]: the density from which other programs sample
};

// Of 1 or 3 channels; one is grey. Symmetries of an anisotropic function are found by trying pairs. Throws
// Error for other functions, and for values that are negative or not finite; Cancelled when the host says so.
RglFit fit_rgl(const AnyBrdf& f, const RglFitOptions& options = {}, const Host& host = {});

// sum |table - f| / sum f over random pairs of directions above the surface, half of them near the mirror
// direction, each weighted by both cosines.
double rgl_fit_error(const RglWideTable& table, const AnyBrdf& f);

// A file that read_rgl_wide_fields() reads back as it is.
Bytes write_rgl(const RglFit& fit, const std::string& description);

}  // namespace reflectree
