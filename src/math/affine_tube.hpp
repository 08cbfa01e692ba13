// SPDX-License-Identifier: Apache-2.0
// A linear function, a tube about it and a range, put together and rounded: what every operation
// on affine forms ends with.
#pragma once

#include "reflectree/math/affine_form.hpp"

namespace reflectree::affine {

using Slopes = AffineForm::Slopes;
inline constexpr std::size_t n = AffineForm::variables;

// Half an ulp of float, relative; and with room for the roundings of the form itself, which are of doubles.
inline constexpr double rounded = 0x1.0001p-24, library = 0x1p-22;
// The least normal float: underflow, flushed or gradual, loses less.
inline constexpr double flushed = 0x1p-126;
inline constexpr double largest_float = 0x1.fffffep127;
// The forms' own roundings, relative to the largest term: every sum here has fewer than 32 of them.
inline constexpr double own = 0x1p-48;

inline double radius_of(const Slopes& s) {
  double sum = 0;
  for (const double v : s) sum += std::abs(v);
  return sum;
}

inline bool is_known(const AffineForm& a) { return a.error < detail::infinity; }
inline bool is_log_known(const AffineForm& a) { return a.log_error < detail::infinity; }

// All floats to which the numbers of a range round. Rounding ascends, and keeps 0.
RealInterval rounded_range(RealInterval r, double unit);

// Completes a form with a middle and slopes, whose tube of an error holds the exact result; the range shrinks to
// what the tube allows.
void complete(AffineForm& out, double radius, double error, RealInterval range);

// The same with one rounding to float.
void round(AffineForm& out, double error, RealInterval range, double unit);

AffineForm only_range(RealInterval range, double unit);

// Holds a function of one variable between two lines of slope alpha.
AffineForm between_lines(const AffineForm& x, double alpha, double lo, double hi, RealInterval range,
                         double unit);

}  // namespace reflectree::affine
