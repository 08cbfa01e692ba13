// SPDX-License-Identifier: Apache-2.0
// Densities in the plane of incidence, per solid angle: what a sampler should follow and what it does.
#pragma once

#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/sampler/any_sampler.hpp"

namespace reflectree::study {

// Degrees from the normal, positive on the viewer's side; dense about the mirror direction and wo.
std::vector<double> plane_angles(double theta_o_deg);
// At these angles, to four digits: t cos_i / albedo.
std::vector<double> target_slice(const AnyBrdf& f, const Target& target, double theta_o_deg, double albedo,
                                 double phi_o_deg = 0);
// And the sampler's pdf; empty where it has none.
std::vector<double> density_slice(const AnySampler<Spectrum>& sampler, double theta_o_deg,
                                  double phi_o_deg = 0);

}  // namespace reflectree::study
