// SPDX-License-Identifier: Apache-2.0
// The referee's own reading of f: the target by its definition, in double, and channels one by one.
#pragma once

#include <span>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/verify/erased.hpp"

namespace reflectree {

// What brdf/target.hpp promises, written a second time: the norm is the root of the sum of squares, which no
// other target of the same channels beats in summed variance; the others mix in 1 % of it.
double reference_target(const Target& target, std::span<const float> channels);

// Channel values at wi[i], from out[i * channels] on; zero below the surface. The half vector is formed in
// double: in float, wo + wi loses the digits of the sharpest lobes.
void channel_values(const AnyBrdf& f, Vec3<double> wo, std::span<const Vec3<double>> wi,
                    std::span<float> out);

// The sum over channels of coefficient * f, as a function to integrate.
TargetFunction combined_channels(AnyBrdf f, std::vector<double> coefficients);

}  // namespace reflectree
