// SPDX-License-Identifier: Apache-2.0
// Fits one slice of an RGL file, the tables of a known direction, to a function whose normals are fitted.
#pragma once

#include "reflectree/formats/rgl_fit.hpp"
#include "rgl_normals.hpp"

namespace reflectree {

// vndf: the density of visible normals over the square; colours: [channel][y][x], S on the warped square.
struct RglSlice {
  std::vector<float> vndf, colours, luminance;
};

// Radians. Throws Error where f is negative or not finite at a node.
RglSlice fit_rgl_slice(const AnyBrdf& f, const RglNormals& normals, const RglFitOptions& options,
                       bool isotropic, double theta_o, double phi_o);

}  // namespace reflectree
