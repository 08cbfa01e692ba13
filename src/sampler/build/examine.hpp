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
  Coordinates brightest_at{};  // of families
  float asymmetry = 0;         // mean |T - mirrored T| / mean T
  ScaleLaw widths = {};        // of families: of lobes of half vectors, along the frame's axes
};

// Refuses functions that are negative, NaN or infinite, or that differ between two calls. Looks at sharp
// lobes that f tells of or that were met. A function is isotropic where the worst pair says so, to rounding.
Examination examine(const AnyBrdf& f, const BuildOptions& options, const std::vector<Ridge>& ridges = {});

// Whether the function is left alone by the symmetry, at every pair looked at and up to rounding.
bool has_symmetry(const AnyBrdf& f, const ViewerFrame& frame, std::uint64_t seed);
// How far, in slopes of the half vector and for the viewer at the normal, the lobe reaches at an azimuth
// before it has fallen to half of its height; 1 where there is none.
float reach_at(const AnyBrdf& f, const Target& target, float phi);

}  // namespace reflectree::detail
