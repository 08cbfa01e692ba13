// SPDX-License-Identifier: Apache-2.0
// The second form that values of one sign have, that of the logarithm of their size.
#pragma once

#include "affine_tube.hpp"

namespace reflectree::affine {

// A form that holds what a logarithm's form holds.
struct LogForm {
  double middle;
  Slopes slope;
  double error;
  double size() const { return std::abs(middle) + radius_of(slope) + error; }
};
inline LogForm kept_log(const AffineForm& a) { return {a.log_middle, a.log_slope, a.log_error}; }

inline constexpr LogForm log_one{0, {}, 0};

// log x on [a, b] lies between alpha x + low and alpha x + high.
struct LinesOfLog {
  double log_a, log_b, alpha, low, high;
};
LinesOfLog lines_of_log(double a, double b);

// log |x| where nobody kept it, between secant and tangent; infinite error where x may be 0 or spans too much for
// lines.
LogForm log_of(const AffineForm& x);

// Gives x, that was rounded once, the logarithm a + sign b.
void add_log(AffineForm& x, const LogForm& a, double sign, const LogForm& b, double unit);

// log(a + b) = log a + log(1 + e^u), u = log b - log a, for positive a and b one of which kept its logarithm:
// convex in u, with a second derivative of at most 1/4. Or log a, where b is a slack.
void add_log_of_sum(AffineForm& out, const AffineForm& a, double sign, const AffineForm& b, double unit);

// -x.
AffineForm turned_around(const AffineForm& x);
// e^log; its exponents are known to lie in a range.
AffineForm exponential(const LogForm& log, RealInterval exponents, RealInterval range, double unit);

// x by whichever of its two forms is narrower.
class Settled {
 public:
  explicit Settled(const AffineForm& x) : form_(&x) {
    if (!is_log_known(x)) return;
    // About what exp adds: a quarter of the square of the radius.
    const double radius = radius_of(x.log_slope) + x.log_error;
    if (!(x.range.magnitude() * (0.2 * radius * radius + x.log_error) < x.error)) return;
    const bool positive = x.range.lo > 0;
    other_ = exponential(kept_log(x), RealInterval::whole(), positive ? x.range : -x.range, 0);
    if (!positive) other_ = turned_around(other_);
    if (other_.error < x.error) form_ = &other_;
  }
  Settled(const Settled&) = delete;
  Settled& operator=(const Settled&) = delete;
  const AffineForm& form() const { return *form_; }

 private:
  const AffineForm* form_;
  AffineForm other_;
};

}  // namespace reflectree::affine
