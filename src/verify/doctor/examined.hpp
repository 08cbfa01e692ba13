// SPDX-License-Identifier: Apache-2.0
// What the doctor's checks look at: what was drawn and integrated for every viewer.
#pragma once

#include "functions.hpp"

namespace reflectree::detail {

// Midpoints of a grid in every bin, to integrate whatever is a product of known functions.
struct Nodes {
  Directions wi;
  std::vector<double> solid_angle;
  std::vector<std::size_t> bin;
};

// Everything about one viewer. Draws that are lost or below the horizon are counted and not kept.
struct ExaminedView : DoctorView {
  std::string where;  // "theta_o 55 deg"
  Nodes nodes;
  std::vector<double> pdf_at, f_cos_at;  // at the nodes; f_cos of the target
  double pdf_integral = 0, pdf_error = 0, albedo = 0;
  std::vector<double> channel_albedo;

  Directions wi;
  std::vector<double> pdf, weight;  // sample's pdf; of the target
  std::vector<std::size_t> bin;
  std::vector<int> order;             // for every draw its place in wi, or -1: neighbours in time
  std::vector<double> light, light2;  // sums of weights and of their squares per bin
  double below = 0;                   // draws below the horizon that carry a weight
  Direction a_below{};
  double draws_lost_below = 0;  // lost draws whose direction lies below the horizon,
  Directions lost_below;        // and some of them
  double broken = 0;            // draws whose direction or pdf is not finite, counted as lost
  double broken_values = 0;     // draws whose value is not finite, counted as 0
  double seconds = 0;           // of drawing
};

std::vector<ExaminedView> examine_views(const Functions& f, const DoctorOptions& options, const Host& host);

// Counts of a view as the checks of chi_square.hpp take them.
struct Fit {
  double statistic = 0, dof = 1, p_value = 1, integral = 0;
};
// Directions against masses per bin; lost draws against what the masses leave out,
// unless the shape alone counts.
Fit fit_of(const DoctorView& view, std::span<const double> mass, bool shape_alone = false);
// Integral of pdf + share of draws that are lost or below the horizon - 1.
double unaccounted(const ExaminedView& view);
// How far integral + lost share may be from 1, at z standard deviations of that share.
double integral_tolerance(const ExaminedView& view, double z);

}  // namespace reflectree::detail
