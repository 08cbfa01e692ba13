// SPDX-License-Identifier: Apache-2.0
// What the builder finds out about a function before it builds.
#pragma once

#include "field.hpp"
#include "reflectree/sampler/build.hpp"

namespace reflectree::detail {

struct Examination {
  Target target;                 // the one asked for, with a scale where floats need one
  ViewerFrame frame;             // isotropic, or what is left of it
  float stretch = 1;             // of lobes of half vectors along the frame's x axis: its root
  bool mirror_symmetric = true;  // to rounding, about the plane of incidence
  // Of the pairs looked at, in the viewer's frame.
  Direction brightest_wo{0, 0, 1}, brightest_wi{0, 0, 1};
  float asymmetry = 0;  // mean |T - mirrored T| / mean T
};

// Refuses functions that are negative, NaN or infinite, or that differ between two calls. Looks at sharp
// lobes that f tells of or that were met. A function is isotropic where the worst pair says so, to rounding.
Examination examine(const AnyBrdf& f, const BuildOptions& options, const std::vector<Ridge>& ridges = {});

// The domain with the fewest leaves in trial trees over thin slabs from the normal to grazing.
Domain choose_domain(const AnyBrdf& f, const BuildOptions& options, const Examination& seen,
                     const std::vector<Ridge>& ridges, const Host& host);

}  // namespace reflectree::detail
