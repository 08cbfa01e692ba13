// SPDX-License-Identifier: Apache-2.0
#include "form_integral.hpp"

#include <cmath>

namespace reflectree::detail {

namespace {

// Room for the roundings of doubles here, relative to the largest term.
constexpr double own = 0x1p-46;

double mean_of_exponential(double s) { return std::abs(s) < 1e-4 ? 1 + s * s / 6 : std::sinh(s) / s; }

ElevationLine by_logarithm(const AffineForm& form) {
  const double s = form.log_slope[0];
  const double middle = std::exp(form.log_middle) * mean_of_exponential(form.log_slope[1]) *
                        mean_of_exponential(form.log_slope[2]);
  // e^(s e) lies between its secant and the tangent of that slope, s times the mean.
  const double mean = mean_of_exponential(s), top = std::exp(std::abs(s));
  const double secant = std::cosh(s), tangent = mean - mean * std::log(mean);
  const double at = 0.5 * (secant + tangent), bend = 0.5 * std::max(secant - tangent, 0.);
  const double error = bend + top * (std::expm1(form.log_error) + (1 + std::abs(form.log_middle)) * own);
  return {middle * (at - s * mean), middle * (at + s * mean), middle * error};
}

}  // namespace

ElevationLine mean_over_square(const AffineForm& form) {
  const double size = std::abs(form.middle) + std::abs(form.slope[0]);
  const ElevationLine plain{form.middle - form.slope[0], form.middle + form.slope[0],
                            form.error + size * own};
  if (!(form.log_error < 1) || !(std::abs(form.log_middle) < 300)) return plain;
  for (const double s : form.log_slope) {
    if (!(std::abs(s) < 4)) return plain;
  }
  const ElevationLine other = by_logarithm(form);
  return other.error < plain.error ? other : plain;
}

std::size_t ElevationSum::lower_half(std::size_t node) {
  if (nodes_[node].lower == 0) {
    nodes_[node].lower = nodes_.size();
    nodes_.resize(nodes_.size() + 2);
  }
  return nodes_[node].lower;
}

void ElevationSum::add(std::size_t node, const ElevationLine& line) {
  constexpr double rounding = 0x1p-52;
  ElevationLine& sum = nodes_[node].line;
  sum.lo += line.lo, sum.hi += line.hi, sum.error += line.error;
  sum.error += rounding * (std::abs(sum.lo) + std::abs(sum.hi) + sum.error);
}

void ElevationSum::add(std::size_t node, const ElevationSum& other, std::size_t its) {
  const Node from = other.nodes_[its];
  add(node, from.line);
  if (from.lower == 0) return;
  const std::size_t lower = lower_half(node);
  add(lower, other, from.lower), add(lower + 1, other, from.lower + 1);
}

}  // namespace reflectree::detail
