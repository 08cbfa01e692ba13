// SPDX-License-Identifier: Apache-2.0
// Spectra and tristimulus values as linear RGB: primaries and white of ITU-R BT.709, seen under D65.
#pragma once

#include <vector>

#include "reflectree/brdf/value.hpp"

namespace reflectree {

Rgb rgb_of_xyz(double x, double y, double z);

// How much a reflectance of 1 at each wavelength, nm and ascending, linear between them and 0 beyond the
// ends, adds to a colour. The weights of a dense list sum to about {1, 1, 1}.
std::vector<Rgb> rgb_of_wavelengths(const std::vector<float>& wavelengths);

}  // namespace reflectree
