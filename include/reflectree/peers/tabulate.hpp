// SPDX-License-Identifier: Apache-2.0
// The target over a chart's square, as tables want it: T = t cos theta_i times the Jacobian.
#pragma once

#include <span>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/peers/square_chart.hpp"

namespace reflectree {

// T at points of the square, 0 below the horizon. The chart is that of a wo at azimuth 0; f is asked with both
// directions turned by phi_o.
void chart_target(const AnyBrdf& f, Target target, SquareChart chart, float theta_o,
                  std::span<const Vec2<float>> points, std::span<float> out, float phi_o = 0);

// [y][x]: T at width x height nodes, corners included; where `floor` is not zero nothing lies below that
// share of the mean, so that no support is lost between nodes.
std::vector<float> chart_nodes(const AnyBrdf& f, Target target, SquareChart chart, float theta_o, int width,
                               int height, float floor, float phi_o = 0);
// [y][x]: means over width x height cells, from 2 x 2 points each; the same floor.
std::vector<float> chart_cells(const AnyBrdf& f, Target target, SquareChart chart, float theta_o, int width,
                               int height, float floor, float phi_o = 0);

// `count` elevations from 0 to just under 90 degrees, denser towards grazing.
std::vector<float> slice_angles(int count);

}  // namespace reflectree
