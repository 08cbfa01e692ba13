// SPDX-License-Identifier: Apache-2.0
// A material's part of the report page, from its BRDF and its sampler's canonical data. The caller adds
// what only it knows: samples, memory, seconds, nanoseconds, chi-square.
#pragma once

#include <functional>
#include <span>

#include "reflectree/draw/material_figures.hpp"
#include "reflectree/draw/report.hpp"

namespace reflectree::draw {

// Domain, bounds, slabs, leaves, and what the builder measured about itself.
ReportFigures figures_of(const SamplerData& data);

// Target, tree, samples and lobe. `samples` are directions for viewer_at(theta_o);
// 10^5 or more fill the histogram.
ReportView view_of(const AnyBrdf& f, const SamplerData& data, float theta_o,
                   std::span<const Direction> samples);

// All of it: one view for every theta_o (radians), a thumbnail at 45 degrees, slabs and square.
using DrawSamples = std::function<std::vector<Direction>(Direction wo)>;
ReportMaterial material_report(const AnyBrdf& f, const SamplerData& data, std::span<const float> theta_o,
                               const DrawSamples& draw_samples);

}  // namespace reflectree::draw
