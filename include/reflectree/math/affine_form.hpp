// SPDX-License-Identifier: Apache-2.0
// Affine forms: a value over a box of a few variables as a linear function and a tube about it, after Comba and
// Stolfi 1993, "Affine arithmetic and its applications to computer graphics"; with it goes the range. What an
// interval loses (that x - x is 0) a form keeps, so that bounds close in with the square of the box's width.
//
// A form speaks of programs. It holds every value that a formula has at a point of the box where the result of
// each operation is exact, or rounded to float (to nearest, underflow flushed or not), or anything between: the
// C library's functions within 4 ulp of float. The same formula, instantiated with float and run anywhere in
// the box, returns a number of the form, whatever its rounding does on the way. A value that may leave the
// range of float may be infinite.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "reflectree/math/direction.hpp"
#include "reflectree/math/interval.hpp"

namespace reflectree {

struct AffineForm {
  // As many as a proof has at most: two coordinates of the square, two of the viewer, two parameters; a number on
  // the way that is divided as they are; the error of one.
  static constexpr std::size_t variables = 8;
  using Slopes = std::array<double, variables>;

  // The values at e in [-1, 1]^8: middle + slope . e, up to `error`; all of them lie in `range`.
  double middle = 0;
  Slopes slope{};
  double error = 0;  // infinite: the range alone is known
  RealInterval range;
  // Of values of one sign also the logarithm of their size, as another form: products of many factors that rise and
  // fall against each other stay narrow there. Unknown where log_error is infinite.
  double log_middle = 0;
  Slopes log_slope{};
  double log_error = detail::infinity;

  constexpr AffineForm() = default;
  // A constant of the formula, which floats round.
  template <class A>
  requires std::is_arithmetic_v<A>
  constexpr explicit AffineForm(A number) : middle(double(number)) {
    constexpr double unit = 0x1.0001p-24;
    // The bits that a float lacks. (A rounding to float and back is what g++ 12 may leave out of two at once.)
    const bool exact =
        std::is_same_v<A, float> || (std::bit_cast<std::uint64_t>(middle) & std::uint64_t(0x1fffffff)) == 0;
    error = exact ? 0 : (middle < 0 ? -middle : middle) * unit;
    range = {middle - error, middle + error};
  }
  // Variable k, from lo to hi.
  static AffineForm variable(std::size_t k, double lo, double hi);
  // Anything in the range.
  static AffineForm anything_in(RealInterval range);

  // Whether they are the same form, and so the same number at every point.
  friend bool operator==(const AffineForm&, const AffineForm&) = default;
  friend AffineForm operator-(const AffineForm& a);
  friend AffineForm operator+(const AffineForm& a, const AffineForm& b);
  friend AffineForm operator-(const AffineForm& a, const AffineForm& b);
  friend AffineForm operator*(const AffineForm& a, const AffineForm& b);
  friend AffineForm operator/(const AffineForm& a, const AffineForm& b);
};

AffineForm sqr(const AffineForm& x);
AffineForm sqrt(const AffineForm& x);
AffineForm abs(const AffineForm& x);
AffineForm min(const AffineForm& a, const AffineForm& b);
AffineForm max(const AffineForm& a, const AffineForm& b);
AffineForm exp(const AffineForm& x);
AffineForm expm1(const AffineForm& x);
AffineForm log(const AffineForm& x);
AffineForm log1p(const AffineForm& x);
AffineForm pow(const AffineForm& x, const AffineForm& y);  // x >= 0
AffineForm sin(const AffineForm& x);
AffineForm cos(const AffineForm& x);
AffineForm asinh(const AffineForm& x);
AffineForm acos(const AffineForm& x);
AffineForm atan2(const AffineForm& y, const AffineForm& x);
// Of two expressions that agree, up to 8 roundings, where s is 0: there the sign bit of s may say either.
AffineForm by_sign(const AffineForm& s, const AffineForm& if_positive, const AffineForm& if_negative);
// x where s has no sign. A box in which s is 0 at a border and negative inside takes -x.
AffineForm flip_sign(const AffineForm& x, const AffineForm& s);

// first + weights . x, summed in any order, products fused or not.
AffineForm weighted_sum(float first, std::span<const float> weights, std::span<const AffineForm> x);
// What holds every number that one of two forms holds; narrow where both hold about the same.
AffineForm either(const AffineForm& a, const AffineForm& b);
// Of two forms of the same number the better parts.
AffineForm narrower(const AffineForm& a, const AffineForm& b);
// x with the error of its logarithm as the slope of variable k, on which nothing else depends: what several factors
// owe to it cancels where it would add up. x as it stands where it has no logarithm.
AffineForm with_named_error(const AffineForm& x, std::size_t k);
// x as it stands, or more or less by up to a share of itself.
AffineForm widened(const AffineForm& x, double share);
// alpha x + [lo, hi], which hold a function of x; `range`: all its values.
AffineForm linear_enclosure(const AffineForm& x, double alpha, RealInterval offset, RealInterval range);
// No less than every value of a - factor b, in exact arithmetic; factor >= 0. Infinite where nothing is known.
double upper_of_difference(const AffineForm& a, double factor, const AffineForm& b);
// The slopes of a - factor b.
AffineForm::Slopes slopes_of_difference(const AffineForm& a, double factor, const AffineForm& b);

// Formulas take the branches that they take for floats.
template <>
inline constexpr bool single_precision<AffineForm> = true;

}  // namespace reflectree
