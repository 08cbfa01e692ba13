// SPDX-License-Identifier: Apache-2.0
// The distribution of normals that an RGL file rests on, and its projected area, fitted from a BRDF.
#pragma once

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/tables/rgl_wide_table.hpp"
#include "reflectree/host.hpp"

namespace reflectree {

// Luminance of 1 or 3 channels, ITU-R BT.709.
float luminance_of(const float* value, int channels);

struct RglNormals {
  RglSquare ndf, sigma;  // [v][u]; of isotropic functions two rows, alike
};

// `size` nodes per side.
RglNormals fit_normals(const AnyBrdf& f, bool isotropic, int size, const Host& host);

// Bilinear, as readers of the file do it.
double on_square(const RglSquare& table, double u, double v);

}  // namespace reflectree
