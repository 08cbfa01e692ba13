// SPDX-License-Identifier: Apache-2.0
// What the doctor's checks look at: the patient's functions with conventions settled, and what was drawn and
// integrated for every viewer.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "parallel.hpp"
#include "reflectree/verify/doctor.hpp"
#include "reflectree/verify/erased.hpp"

namespace reflectree::detail {

using Directions = std::vector<Direction>;

inline bool sane(double x) { return std::isfinite(x) && x >= 0; }
// What cannot be integrated counts as 0; the sweep has told of it by then.
inline double sane_or_zero(double x) { return sane(x) ? x : 0; }

// The patient, its conventions settled.
class Functions {
 public:
  Functions(const Patient& patient, EvalKind eval_kind, ValueKind value_kind)
      : p_(patient), eval_kind_(eval_kind), value_kind_(value_kind) {}

  const Patient& patient() const { return p_; }
  std::size_t channels() const { return std::size_t(p_.channels); }
  bool has_pdf() const { return bool(p_.pdf); }
  EvalKind eval_kind() const { return eval_kind_; }
  ValueKind value_kind() const { return value_kind_; }

  // What eval and pdf return, in batches that a pipe can take; as many wo as wi.
  std::vector<double> raw(std::span<const Direction> wo, std::span<const Direction> wi) const;
  std::vector<double> pdf(std::span<const Direction> wo, std::span<const Direction> wi) const;
  // f cos_theta_i, channel by channel.
  std::vector<double> f_cos(std::span<const Direction> wo, std::span<const Direction> wi) const;

  struct Draws {
    std::vector<PatientDraw> draw;
    std::vector<double> value;  // as returned
  };
  Draws draw(std::span<const Direction> wo, std::uint64_t seed) const;
  // f cos_theta_i / pdf of a draw; 0 for a lost one. f_cos: of that direction, for samplers without a value.
  double weight(const PatientDraw& d, double value, double f_cos) const;

  // The root of the sum of squares over channels, of what is sane.
  double target(std::span<const double> channels) const;
  // The two as functions to integrate: f, and pdf over the cosine.
  TargetFunction target_function() const;
  TargetFunction density_function() const;

 private:
  const Patient& p_;
  EvalKind eval_kind_;
  ValueKind value_kind_;
};

// A draw without a direction above the surface that carries nothing.
bool is_lost(const PatientDraw& d, std::span<const double> values, bool has_pdf);

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
  double broken = 0;   // draws that are not finite, counted as lost
  double seconds = 0;  // of drawing
};

std::vector<ExaminedView> examine_views(const Functions& f, const DoctorOptions& options, const Host& host);

// Draws one by one, for anything that must hold at each of them.
struct Pointwise {
  Directions wo, wi;
  std::vector<double> pdf;    // sample's
  std::vector<double> value;  // as returned, channel by channel
  std::size_t size() const { return wi.size(); }
};
Pointwise draw_pointwise(const Functions& f, int viewers, int draws, std::uint64_t seed);

// Counts of a view as the checks of chi_square.hpp take them.
struct Fit {
  double statistic = 0, dof = 1, p_value = 1, integral = 0;
};
// Directions against masses per bin; lost draws against what the masses leave out, unless the shape alone
// counts.
Fit fit_of(const DoctorView& view, std::span<const double> mass, bool shape_alone = false);
// How far integral + lost share may be from 1, at z standard deviations of that share.
double integral_tolerance(const ExaminedView& view, double z);

std::string in_words(Direction w);
double degrees(double radians);

}  // namespace reflectree::detail
