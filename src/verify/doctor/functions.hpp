// SPDX-License-Identifier: Apache-2.0
// The patient's functions with conventions settled.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "reflectree/verify/doctor.hpp"
#include "reflectree/verify/erased.hpp"

namespace reflectree::detail {

using Directions = std::vector<Direction>;

inline constexpr std::size_t batch = 1 << 16;  // rows of one call

inline bool sane(double x) { return std::isfinite(x) && x >= 0; }
// What cannot be integrated counts as 0; the sweep has told of it by then.
inline double sane_or_zero(double x) { return sane(x) ? x : 0; }

inline Vec3<double> widen(Direction w) { return {double(w.x), double(w.y), double(w.z)}; }
inline Direction narrow(Vec3<double> w) { return {float(w.x), float(w.y), float(w.z)}; }

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

// Draws one by one, for anything that must hold at each of them.
struct Pointwise {
  Directions wo, wi;
  std::vector<double> pdf;    // sample's
  std::vector<double> value;  // as returned, channel by channel
  std::size_t size() const { return wi.size(); }
};
Pointwise draw_pointwise(const Functions& f, int viewers, int draws, std::uint64_t seed);

std::string in_words(Direction w);
double degrees(double radians);

}  // namespace reflectree::detail
