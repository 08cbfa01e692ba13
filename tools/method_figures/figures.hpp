// SPDX-License-Identifier: Apache-2.0
// The figures of docs/method.md, one function per step of the method.
#pragma once

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/draw/figure.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree::method {

// The material of all figures but where a figure names another: red plastic that also returns light to the
// viewer, built by build().
struct Example {
  AnyBrdf f;
  SamplerData data;
  Direction wo;  // 50 degrees
};
Example make_example();

// Target, tree, samples and lobe in a row: the method in one picture.
draw::Figure overview_figure(const Example& example);
draw::Figure problem_figure(const Example& example);
draw::Figure domains_figure();
draw::Figure albedo_figure();
draw::Figure normalised_bounds_figure();
draw::Figure tree_growth_figure(const Example& example);
draw::Figure descent_figure(const Example& example);
draw::Figure corner_codes_figure();
draw::Figure rejection_figure(const Example& example);
draw::Figure restart_figure(const Example& example);
draw::Figure one_shot_figure(const Example& example);

}  // namespace reflectree::method
