// SPDX-License-Identifier: Apache-2.0
// The albedo over theta_o as polynomials on panels: what is integrated at few elevations and looked up at any.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <vector>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/sampler/known/albedo.hpp"

namespace reflectree::detail {

// A panel of the table: five equidistant nodes in theta_o (in which measured tables are smooth at the normal,
// where the cosine has a branch point) and the polynomial through them. Between kinks the albedo is smooth,
// so that a few integrals serve many entries of the table.
struct Panel {
  double lo, hi;
  int level = 0;
  bool jump = false;  // as narrow as it gets: the albedo leaps across it
  // At the odd nodes, by the panel that was halved.
  std::array<double, 2> predicted{std::numeric_limits<double>::infinity(),
                                  std::numeric_limits<double>::infinity()};
  double bend = 0;  // how far its nodes are from a parabola, in units of what is allowed
};
double node_of(const Panel& panel, int i);
float cosine_of(double theta);
// The polynomial through the values at t = 0, step, ... of the five nodes, at t in [0, 4].
double interpolate(const std::array<double, 5>& values, int step, double t);

// How many times the stated error a table may miss: once, ten times beyond 89.9 degrees.
inline double times_allowed(float cos_theta_o) { return cos_theta_o < 1.745e-3f ? 10 : 1; }

// What the function knows about its albedo: a factor over theta_o, radians.
using Factor = std::function<double(double theta_o)>;
// Appends the entries of the panel after its lower end, so that lines in the cosine miss the polynomial times
// the factor by at most `error`, relatively.
void tabulate(const Panel& panel, const std::array<double, 5>& values, const Factor& factor, double error,
              std::map<float, double>& table);

// Where panels begin, in radians: what a function's traits and the kinks of measured tables suggest.
std::vector<double> first_borders(const BrdfTraits& traits);

}  // namespace reflectree::detail
