// SPDX-License-Identifier: Apache-2.0
// What the builder finds out about a function before it builds.
#pragma once

#include "field.hpp"
#include "reflectree/sampler/build.hpp"

namespace reflectree::detail {

struct Examination {
  Target target;                 // the one asked for, with a scale where floats need one
  bool mirror_symmetric = true;  // to rounding
  Direction brightest_wo{0, 0, 1}, brightest_wi{0, 0, 1};  // of the pairs looked at, wo at azimuth 0
  float asymmetry = 0;                                     // mean |T - mirrored T| / mean T
};

// Refuses functions that are negative, NaN or infinite, that differ between two calls or that depend on
// more than theta_o, theta_i and phi_o - phi_i. Looks at sharp lobes that f tells of or that were met.
Examination examine(const AnyBrdf& f, const BuildOptions& options, const std::vector<Ridge>& ridges = {});

// The domain with the fewest leaves in trial trees over thin slabs from the normal to grazing.
Domain choose_domain(const AnyBrdf& f, const BuildOptions& options, const Examination& seen,
                     const std::vector<Ridge>& ridges, const Host& host);

}  // namespace reflectree::detail
