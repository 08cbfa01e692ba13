// SPDX-License-Identifier: Apache-2.0
// Sums, products, and choices between forms.
#include "affine_logarithm.hpp"

namespace reflectree {

using namespace affine;

namespace {

AffineForm product(const AffineForm& a, const AffineForm& b, RealInterval range, double unit) {
  if (!is_known(a) || !is_known(b)) return only_range(range, unit);
  AffineForm out;
  double middle = a.middle * b.middle, square = 0, cross = 0, radius_a = 0, radius_b = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (a.slope[i] == 0 && b.slope[i] == 0) continue;  // variables that are not there
    out.slope[i] = a.middle * b.slope[i] + b.middle * a.slope[i];
    // e^2 is in [0, 1]; e e' in [-1, 1].
    const double d = a.slope[i] * b.slope[i];
    middle += 0.5 * d;
    square += std::abs(d);
    radius_a += std::abs(a.slope[i]), radius_b += std::abs(b.slope[i]);
    for (std::size_t k = 0; k < i; ++k) cross += std::abs(a.slope[i] * b.slope[k] + a.slope[k] * b.slope[i]);
  }
  out.middle = middle;
  const double size_a = std::abs(a.middle) + radius_a, size_b = std::abs(b.middle) + radius_b;
  round(
      out,
      0.5 * square + cross + a.error * size_b + b.error * size_a + a.error * b.error + size_a * size_b * own,
      range, unit);
  return out;
}

AffineForm sum(const AffineForm& the_a, double sign, const AffineForm& the_b, double unit) {
  const Settled settled_a(the_a), settled_b(the_b);
  const AffineForm &a = settled_a.form(), &b = settled_b.form();
  const RealInterval range = sign > 0 ? a.range + b.range : a.range - b.range;
  if (!is_known(a) || !is_known(b)) return only_range(range, unit);
  AffineForm out;
  double size = std::abs(a.middle) + std::abs(b.middle);
  for (std::size_t i = 0; i < n; ++i) {
    out.slope[i] = a.slope[i] + sign * b.slope[i];
    size += std::abs(a.slope[i]) + std::abs(b.slope[i]);
  }
  out.middle = a.middle + sign * b.middle;
  round(out, a.error + b.error + size * own, range, unit);
  if (!out.range.contains(0)) add_log_of_sum(out, the_a, sign, the_b, unit);
  return out;
}

// 1 / x, not rounded; x does not hold 0. The secant 1/a + 1/b - x / (a b) lies above, 2 r - r^2 x with
// r^2 = 1 / (a b) below.
AffineForm inverse(const AffineForm& x) {
  const RealInterval range = RealInterval(1) / x.range;
  if (x.range.hi < 0) return -inverse(-x);
  const double a = x.range.lo, b = x.range.hi;
  const double alpha = -1 / (a * b);
  if (!(a > 0) || !std::isfinite(b) || !std::isfinite(alpha)) return AffineForm::anything_in(range);
  return between_lines(x, alpha, 2 * std::sqrt(-alpha), std::max(1 / a - alpha * a, 1 / b - alpha * b), range,
                       0);
}

// max(x, 0) for x of both signs.
AffineForm ramp(const AffineForm& x) {
  const double a = x.range.lo, b = x.range.hi;
  const RealInterval range{0, b};
  if (!std::isfinite(a) || !std::isfinite(b)) return AffineForm::anything_in(range);
  const double alpha = b / (b - a);
  return between_lines(x, alpha, 0, std::max(-alpha * a, b - alpha * b), range, 0);
}

}  // namespace

AffineForm operator-(const AffineForm& a) { return turned_around(Settled(a).form()); }
AffineForm operator+(const AffineForm& a, const AffineForm& b) { return sum(a, 1, b, rounded); }
AffineForm operator-(const AffineForm& a, const AffineForm& b) { return sum(a, -1, b, rounded); }
AffineForm operator*(const AffineForm& a, const AffineForm& b) {
  AffineForm out = product(a, b, a.range * b.range, rounded);
  if (!out.range.contains(0)) add_log(out, log_of(a), 1, log_of(b), rounded);
  return out;
}
AffineForm operator/(const AffineForm& a, const AffineForm& b) {
  const RealInterval range = a.range / b.range;
  if (b.range.lo <= 0 && b.range.hi >= 0) return only_range(range, rounded);
  AffineForm out = product(a, inverse(Settled(b).form()), range, rounded);
  if (!out.range.contains(0)) add_log(out, log_of(a), -1, log_of(b), rounded);
  return out;
}

AffineForm sqr(const AffineForm& x) {
  AffineForm out = product(x, x, sqr(x.range), rounded);
  if (x.range.contains(0)) return out;
  const LogForm log = log_of(x);
  add_log(out, log, 1, log, rounded);
  return out;
}

// A sum of n products in floats errs by less than (n + 1) u of the sum of their sizes (Higham 2002, "Accuracy and
// Stability of Numerical Algorithms", 3.1, with room for the square of u).
AffineForm weighted_sum(float first, std::span<const float> weights, std::span<const AffineForm> x) {
  AffineForm out;
  out.middle = double(first);
  double size = std::abs(double(first)), error = 0, lo = double(first), hi = lo, terms = 1;
  bool known = true;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double w = double(weights[k]);
    if (w == 0) continue;
    const Settled settled(x[k]);
    const AffineForm& form = settled.form();
    known = known && is_known(form);
    out.middle += w * form.middle, error += std::abs(w) * form.error;
    for (std::size_t i = 0; i < n; ++i) out.slope[i] += w * form.slope[i];
    lo += w * (w > 0 ? form.range.lo : form.range.hi), hi += w * (w > 0 ? form.range.hi : form.range.lo);
    size += std::abs(w) * form.range.magnitude(), terms += 1;
  }
  const double lost = size * (terms + 1) * rounded + terms * flushed, slack = size * terms * own;
  const RealInterval range{lo - slack - lost, hi + slack + lost};
  if (!known || !(size < largest_float)) return AffineForm::anything_in(RealInterval::whole());
  complete(out, radius_of(out.slope), error + slack + lost, range);
  return out;
}

AffineForm abs(const AffineForm& the_x) {
  if (the_x.range.lo >= 0) return the_x;
  const Settled settled(the_x);
  const AffineForm& x = settled.form();
  if (x.range.lo >= 0) return x;
  if (x.range.hi <= 0) return -x;
  const double a = x.range.lo, b = x.range.hi;
  if (!std::isfinite(a) || !std::isfinite(b)) return AffineForm::anything_in(abs(x.range));
  const double alpha = (a + b) / (b - a);
  return between_lines(x, alpha, 0, std::max(-a - alpha * a, b - alpha * b), abs(x.range), 0);
}

AffineForm max(const AffineForm& a, const AffineForm& b) {
  if (a.range.lo >= b.range.hi) return a;
  if (b.range.lo >= a.range.hi) return b;
  const AffineForm over = sum(a, -1, b, 0);
  if (over.range.lo >= 0) return a;
  if (over.range.hi <= 0) return b;
  AffineForm out = sum(b, 1, ramp(over), 0);
  out.range = intersection(out.range, max(a.range, b.range));
  return out;
}
AffineForm min(const AffineForm& a, const AffineForm& b) { return -max(-a, -b); }

AffineForm either(const AffineForm& the_a, const AffineForm& the_b) {
  const Settled settled_a(the_a), settled_b(the_b);
  const AffineForm &a = settled_a.form(), &b = settled_b.form();
  const RealInterval range = hull(a.range, b.range);
  if (!is_known(a) || !is_known(b)) return AffineForm::anything_in(range);
  AffineForm out;
  double apart = std::abs(a.middle - b.middle), size = std::abs(a.middle) + std::abs(b.middle);
  for (std::size_t i = 0; i < n; ++i) {
    out.slope[i] = 0.5 * (a.slope[i] + b.slope[i]);
    apart += std::abs(a.slope[i] - b.slope[i]);
    size += std::abs(a.slope[i]) + std::abs(b.slope[i]);
  }
  out.middle = 0.5 * (a.middle + b.middle);
  complete(out, radius_of(out.slope), 0.5 * apart + std::max(a.error, b.error) + size * own, range);
  return out;
}

AffineForm by_sign(const AffineForm& s, const AffineForm& if_positive, const AffineForm& if_negative) {
  if (s.range.lo > 0) return if_positive;
  if (s.range.hi < 0) return if_negative;
  constexpr double agreement = 0x1p-21;  // 8 roundings
  if (s.range.lo == 0) return widened(if_positive, agreement);
  if (s.range.hi == 0) return widened(if_negative, agreement);
  return either(if_positive, if_negative);
}
AffineForm flip_sign(const AffineForm& x, const AffineForm& s) {
  if (s.range.lo >= 0) return x;
  if (s.range.hi <= 0) return -x;
  return by_sign(s, x, -x);
}

}  // namespace reflectree
