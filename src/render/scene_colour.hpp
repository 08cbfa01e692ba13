// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "reflectree/brdf/value.hpp"

namespace reflectree::render {

// (wavelength in nm, value), ascending, not empty; 0 outside.
using SampledSpectrum = std::vector<std::pair<double, double>>;

Rgb to_linear_srgb(const SampledSpectrum& spectrum, bool reflectance);

}  // namespace reflectree::render
