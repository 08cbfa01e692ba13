// SPDX-License-Identifier: Apache-2.0
// The referee: integrals over the hemisphere by adaptive cubature in its own coordinates.
#pragma once

#include "reflectree/verify/erased.hpp"
#include "reflectree/verify/hemisphere_chart.hpp"

namespace reflectree {

struct ReferenceOptions {
  // The estimated error is generous (about 100 times too large): bilinear tables end at the limit of
  // evaluations with an estimate of some 1e-4 and a true error near 1e-6.
  double relative_tolerance = 1e-5;
  std::size_t max_evaluations = 2'000'000;
  // Only if told: the function is mirror-symmetric about the plane of wo, so half of it is enough.
  bool mirror_symmetric = false;
};

// A chart about the mirror direction of wo, or about the highest point of t cos_i where a search finds
// one that such a chart would not resolve. Of functions that tell of patches: the projected disk.
HemisphereChart choose_chart(const TargetFunction& f, Vec3<double> wo);

// t cos_i d(solid angle) in coordinates of the chart. Keeps references.
Integrand chart_integrand(const TargetFunction& f, Vec3<double> wo, const HemisphereChart& chart);
// A sampler's density likewise, evaluated at float directions.
Integrand chart_integrand(const ErasedSampler& sampler, Direction wo, const HemisphereChart& chart);

// Where cubatures over that chart begin: the patches of f in rows from the normal outwards, or else the whole.
std::vector<CubatureBox> chart_parts(const TargetFunction& f);

// a(wo) = integral of t cos_i, with an estimated error bound.
CubatureResult reference_albedo(const TargetFunction& f, Direction wo, const ReferenceOptions& options = {});

}  // namespace reflectree
