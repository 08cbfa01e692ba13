// SPDX-License-Identifier: Apache-2.0
// The sampler that an RGL file carries in itself: its fields `luminance` and `vndf`, as Dupuy and Jakob 2018
// use them and other renderers do. Read here alone, to set the warp chain that is fitted from f beside it.
#pragma once

#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/sampler/any_sampler.hpp"

namespace reflectree::study {

// `f` is what the file's own reader makes of it. Throws Error.
AnySampler<Spectrum> rgl_own_sampler(const std::string& path, const AnyBrdf& f);
// At which elevations of wo, in radians, its tables stand.
std::vector<float> rgl_elevations(const std::string& path);

}  // namespace reflectree::study
