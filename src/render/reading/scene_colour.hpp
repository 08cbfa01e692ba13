// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "reflectree/brdf/value.hpp"

namespace reflectree::render {

// (wavelength in nm, value), ascending, not empty; 0 outside.
using SampledSpectrum = std::vector<std::pair<double, double>>;

// What a colour is of: a reflectance is seen under D65 and keeps to [0, 1]; so is an index of refraction,
// without a largest value; light is as it is.
enum class ColourOf { reflectance, index, light };
Rgb to_linear_srgb(const SampledSpectrum& spectrum, ColourOf of);
// Light of the same power at every wavelength: not white in sRGB, whose white is D65.
inline constexpr Rgb equal_energy{1.204794f, .948291f, .908916f};

}  // namespace reflectree::render
