// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/affine_form.hpp"

namespace reflectree {

namespace {

using Slopes = AffineForm::Slopes;
constexpr std::size_t n = AffineForm::variables;

// Half an ulp of float, relative; and with room for the roundings of the form itself, which are of doubles.
constexpr double rounded = 0x1.0001p-24, library = 0x1p-22;
// The least normal float: underflow, flushed or gradual, loses less.
constexpr double flushed = 0x1p-126;
constexpr double largest_float = 0x1.fffffep127;
// The forms' own roundings, relative to the largest term: every sum here has fewer than 32 of them.
constexpr double own = 0x1p-48;

double radius_of(const Slopes& s) {
  double sum = 0;
  for (const double v : s) sum += std::abs(v);
  return sum;
}

bool is_known(const AffineForm& a) { return a.error < detail::infinity; }
bool is_log_known(const AffineForm& a) { return a.log_error < detail::infinity; }

// All floats to which the numbers of a range round. Rounding ascends, and keeps 0.
RealInterval rounded_range(RealInterval r, double unit) {
  RealInterval out{r.lo - (std::abs(r.lo) * unit + flushed), r.hi + (std::abs(r.hi) * unit + flushed)};
  if (r.lo >= 0) out.lo = std::max(out.lo, 0.);
  if (r.hi <= 0) out.hi = std::min(out.hi, 0.);
  // Beyond the largest float lies infinity; NaN comes of infinities alone.
  if (!(out.lo >= -largest_float)) out.lo = -detail::infinity;
  if (!(out.hi <= largest_float)) out.hi = detail::infinity;
  return out;
}

// Completes a form with a middle and slopes, whose tube of an error holds the exact result; the range shrinks to
// what the tube allows.
void complete(AffineForm& out, double radius, double error, RealInterval range) {
  const double size = std::abs(out.middle) + radius;
  error += (size + error) * own;
  const double reach = radius + error, slack = (size + error) * own;
  const RealInterval tube{out.middle - reach - slack, out.middle + reach + slack};
  const bool known = error < largest_float && size < largest_float;
  if (known) out.range = intersection(range, tube);
  // Where the tube is wider than the range the slopes say nothing.
  if (!known || !(out.range.lo <= out.range.hi) || error >= 0.5 * (out.range.hi - out.range.lo)) {
    out = AffineForm::anything_in(known && out.range.lo <= out.range.hi ? out.range : range);
    return;
  }
  out.error = error;
}

// The same with one rounding to float.
void round(AffineForm& out, double error, RealInterval range, double unit) {
  const RealInterval r = rounded_range(range, unit);
  const double radius = radius_of(out.slope);
  const double size = std::min(r.magnitude(), (std::abs(out.middle) + radius + error) * (1 + unit + own));
  complete(out, radius, error + size * unit + flushed, r);
}

AffineForm only_range(RealInterval range, double unit) {
  return AffineForm::anything_in(rounded_range(range, unit));
}

// Holds a function of one variable between two lines of slope alpha.
AffineForm between_lines(const AffineForm& x, double alpha, double lo, double hi, RealInterval range,
                         double unit) {
  const double slack = (std::abs(lo) + std::abs(hi) + std::abs(alpha) * x.range.magnitude()) * own;
  if (!is_known(x) || !(slack < largest_float)) return only_range(range, unit);
  AffineForm out;
  for (std::size_t i = 0; i < n; ++i) out.slope[i] = alpha * x.slope[i];
  out.middle = alpha * x.middle + 0.5 * (lo + hi);
  round(out, std::abs(alpha) * x.error + 0.5 * std::max(hi - lo, 0.) + slack, range, unit);
  return out;
}

// A form that holds what a logarithm's form holds.
struct LogForm {
  double middle;
  Slopes slope;
  double error;
  double size() const { return std::abs(middle) + radius_of(slope) + error; }
};
LogForm kept_log(const AffineForm& a) { return {a.log_middle, a.log_slope, a.log_error}; }

// log x where nobody kept it, between secant and tangent; infinite error where x is not positive or spans too
// much for lines.
LogForm log_of(const AffineForm& x) {
  const double a = x.range.lo, b = x.range.hi;
  LogForm out = kept_log(x);
  // About what the lines would add: a sixteenth of the square of the range's width.
  if (is_log_known(x) && !((x.error + 0.1 * (b - a) * (b - a) / a) < 0.7 * x.log_error * a)) return out;
  out = {0, {}, detail::infinity};
  if (!(a > 1e-35) || !(b < 8 * a) || !is_known(x)) return out;
  const double la = std::log(a), lb = std::log(b);
  const double alpha = b > a * (1 + 1e-6) ? (lb - la) / (b - a) : 2 / (a + b);
  // log x - alpha x is largest at 1 / alpha.
  const double low = std::min(la - alpha * a, lb - alpha * b), high = -std::log(alpha) - 1;
  out.middle = alpha * x.middle + 0.5 * (low + high);
  for (std::size_t i = 0; i < n; ++i) out.slope[i] = alpha * x.slope[i];
  out.error = alpha * x.error + 0.5 * std::max(high - low, 0.) + (4 + std::abs(la) + std::abs(lb)) * own;
  return out;
}

// x with a logarithm a + sign b, that was rounded once.
void add_log(AffineForm& x, const LogForm& a, double sign, const LogForm& b, double unit) {
  // Below this the underflow counts.
  if (!(a.error + b.error < 1) || !(x.range.lo > 1e-30)) return;
  x.log_middle = a.middle + sign * b.middle;
  for (std::size_t i = 0; i < n; ++i) x.log_slope[i] = a.slope[i] + sign * b.slope[i];
  x.log_error = a.error + b.error + 1.001 * unit + flushed / x.range.lo + (a.size() + b.size()) * own;
}
constexpr LogForm log_one{0, {}, 0};

AffineForm exponential(const LogForm& log, RealInterval exponents, RealInterval range, double unit);

// x by whichever of its two forms is narrower.
class Settled {
 public:
  explicit Settled(const AffineForm& x) : form_(&x) {
    if (!is_log_known(x)) return;
    // About what exp adds: a quarter of the square of the radius.
    const double radius = radius_of(x.log_slope) + x.log_error;
    if (!(x.range.hi * (0.2 * radius * radius + x.log_error) < x.error)) return;
    other_ = exponential(kept_log(x), RealInterval::whole(), x.range, 0);
    if (other_.error < x.error) form_ = &other_;
  }
  Settled(const Settled&) = delete;
  Settled& operator=(const Settled&) = delete;
  const AffineForm& form() const { return *form_; }

 private:
  const AffineForm* form_;
  AffineForm other_;
};

AffineForm product(const AffineForm& a, const AffineForm& b, RealInterval range, double unit) {
  if (!is_known(a) || !is_known(b)) return only_range(range, unit);
  AffineForm out;
  double middle = a.middle * b.middle, square = 0, cross = 0, radius_a = 0, radius_b = 0;
  for (std::size_t i = 0; i < n; ++i) {
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

bool is_slack(const AffineForm& a) { return radius_of(a.slope) == 0 && a.range.contains(0); }

// log(a + b) = log a + log(1 + e^u), u = log b - log a, for positive a and b one of which kept its logarithm:
// convex in u, with a second derivative of at most 1/4. Or log a, where b is a slack.
void add_log_of_sum(AffineForm& out, const AffineForm& a, double sign, const AffineForm& b, double unit) {
  const double slack = b.range.magnitude();
  if (is_log_known(a) && is_slack(b) && slack < 0.1 * a.range.lo) {
    const LogForm log{0, {}, slack / (a.range.lo - slack) * (1 + own)};
    add_log(out, kept_log(a), 1, log, unit);
    return;
  }
  if (sign < 0 || !(a.range.lo > 0) || !(b.range.lo > 0) || (!is_log_known(a) && !is_log_known(b))) return;
  const LogForm log_a = log_of(a), log_b = log_of(b);
  if (!(log_a.error + log_b.error < 1)) return;
  LogForm u{log_b.middle - log_a.middle, {}, log_a.error + log_b.error};
  for (std::size_t i = 0; i < n; ++i) u.slope[i] = log_b.slope[i] - log_a.slope[i];
  u.error += (log_a.size() + log_b.size()) * own;
  const double reach = radius_of(u.slope) + u.error, lo = u.middle - reach, hi = u.middle + reach;
  if (!(reach < 4) || !(std::abs(u.middle) < 200)) return;
  const auto f = [](double v) { return std::max(v, 0.) + std::log1p(std::exp(-std::abs(v))); };
  const auto rise = [](double v) { return 1 / (1 + std::exp(-v)); };
  const double alpha = reach > 1e-6 ? (f(hi) - f(lo)) / (hi - lo) : rise(u.middle);
  // The tangent at any t lies below; its slope should be alpha.
  const double t = std::clamp(std::log(alpha / std::max(1 - alpha, 1e-300)), lo, hi);
  const double high = std::max(f(lo) - alpha * lo, f(hi) - alpha * hi);
  const double low = f(t) - alpha * t - std::abs(rise(t) - alpha) * (hi - lo);
  // Of log a + alpha u + offset the errors of log a are counted once: log a (1 - alpha) + alpha log b.
  LogForm log{log_a.middle + alpha * u.middle + 0.5 * (low + high), {}, 0};
  for (std::size_t i = 0; i < n; ++i) log.slope[i] = log_a.slope[i] + alpha * u.slope[i];
  log.error = std::abs(1 - alpha) * log_a.error + std::abs(alpha) * log_b.error +
              0.5 * std::max(high - low, 0.) +
              (std::abs(low) + std::abs(high) + log_a.size() + 2 * u.size()) * own;
  add_log(out, log, 1, log_one, unit);
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
  if (out.range.lo > 0) add_log_of_sum(out, the_a, sign, the_b, unit);
  return out;
}

// A concave function on [a, b] between the secant and, parallel to it, the tangent at t (nearly so: what its
// slope misses counts).
struct Curve {
  double value, slope;
};
template <class Function>
AffineForm concave(const AffineForm& x, const Function& f, double t, double alpha, RealInterval range,
                   double unit) {
  const double a = x.range.lo, b = x.range.hi;
  const Curve at = f(t);
  const double low = std::min(f(a).value - alpha * a, f(b).value - alpha * b);
  const double high = at.value - alpha * t + std::abs(at.slope - alpha) * (b - a);
  return between_lines(x, alpha, low, high, range, unit);
}

}  // namespace

AffineForm AffineForm::variable(std::size_t k, double lo, double hi) {
  AffineForm out;
  out.middle = 0.5 * lo + 0.5 * hi;
  out.slope[k] = std::max(out.middle - lo, hi - out.middle);
  out.error = (std::abs(out.middle) + out.slope[k]) * own;
  out.range = {lo, hi};
  return out;
}

AffineForm AffineForm::anything_in(RealInterval range) {
  AffineForm out;
  out.range = range;
  out.middle = 0, out.error = detail::infinity;
  const double middle = range.middle(), radius = 0.5 * range.hi - 0.5 * range.lo;
  if (std::isfinite(middle) && radius < largest_float) {
    out.middle = middle;
    out.error = radius + (std::abs(middle) + radius) * own;
  }
  return out;
}

AffineForm operator-(const AffineForm& the_a) {
  const Settled settled(the_a);
  const AffineForm& a = settled.form();
  AffineForm out;
  out.middle = -a.middle, out.error = a.error, out.range = -a.range;
  for (std::size_t i = 0; i < n; ++i) out.slope[i] = -a.slope[i];
  return out;
}
AffineForm operator+(const AffineForm& a, const AffineForm& b) { return sum(a, 1, b, rounded); }
AffineForm operator-(const AffineForm& a, const AffineForm& b) { return sum(a, -1, b, rounded); }
AffineForm operator*(const AffineForm& a, const AffineForm& b) {
  AffineForm out = product(a, b, a.range * b.range, rounded);
  if (out.range.lo > 0 && a.range.lo > 0) add_log(out, log_of(a), 1, log_of(b), rounded);
  return out;
}
AffineForm operator/(const AffineForm& a, const AffineForm& b) {
  const RealInterval range = a.range / b.range;
  if (b.range.lo <= 0 && b.range.hi >= 0) return only_range(range, rounded);
  AffineForm out = product(a, inverse(Settled(b).form()), range, rounded);
  if (out.range.lo > 0 && a.range.lo > 0) add_log(out, log_of(a), -1, log_of(b), rounded);
  return out;
}

AffineForm sqr(const AffineForm& x) {
  AffineForm out = product(x, x, sqr(x.range), rounded);
  if (!(x.range.lo > 0)) return out;
  const LogForm log = log_of(x);
  add_log(out, log, 1, log, rounded);
  return out;
}

AffineForm sqrt(const AffineForm& the_x) {
  const Settled settled(the_x);
  const AffineForm& x = settled.form();
  const RealInterval range = sqrt(x.range);
  const double a = std::sqrt(std::max(x.range.lo, 0.)), b = std::sqrt(std::max(x.range.hi, 0.));
  if (!(b > 0) || !std::isfinite(b)) return only_range(range, rounded);
  // sqrt x <= alpha x + 1 / (4 alpha) for any alpha.
  const double alpha = 1 / (a + b);
  AffineForm inside = x;
  inside.range.lo = std::max(inside.range.lo, 0.);
  AffineForm out = between_lines(inside, alpha, std::min(a - alpha * a * a, b - alpha * b * b), 0.25 / alpha,
                                 range, rounded);
  LogForm half = log_of(the_x);
  half.middle *= 0.5, half.error *= 0.5;
  for (double& v : half.slope) v *= 0.5;
  add_log(out, half, 1, log_one, rounded);
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

namespace {
AffineForm exponential(const LogForm& log, RealInterval exponents, RealInterval range, double unit) {
  const double reach = radius_of(log.slope) + log.error;
  AffineForm x;
  x.middle = log.middle, x.slope = log.slope, x.error = log.error;
  x.range =
      intersection(exponents, {log.middle - reach - log.size() * own, log.middle + reach + log.size() * own});
  const double a = x.range.lo, b = x.range.hi;
  if (!std::isfinite(a) || !(b < 85)) return only_range(range, unit);
  const double ea = std::exp(a), eb = std::exp(b);
  double alpha = b - a > 1e-6 ? (eb - ea) / (b - a) : std::exp(0.5 * (a + b));
  alpha = std::max(alpha, 1e-300);
  // e^x - alpha x is least at log alpha.
  const double log_alpha = std::log(alpha), slack = (1 + std::abs(log_alpha)) * alpha * own;
  AffineForm out = between_lines(x, alpha, alpha * (1 - log_alpha) - slack,
                                 std::max(ea - alpha * a, eb - alpha * b) + eb * own, range, unit);
  add_log(out, log, 1, log_one, unit);
  return out;
}
}  // namespace

AffineForm exp(const AffineForm& the_x) {
  const Settled settled(the_x);
  const AffineForm& x = settled.form();
  const RealInterval range = exp(x.range);
  if (!is_known(x)) return only_range(range, library);
  return exponential({x.middle, x.slope, x.error}, x.range, range, library);
}

AffineForm log(const AffineForm& x) {
  const RealInterval range = log(x.range);
  const double a = x.range.lo, b = x.range.hi;
  if (!(a > 0) || !std::isfinite(b)) return only_range(range, library);
  const double la = std::log(a), lb = std::log(b);
  const double alpha = b > a * (1 + 1e-6) ? (lb - la) / (b - a) : 2 / (a + b);
  // log x - alpha x is largest at 1 / alpha.
  const double slack = (1 + std::abs(la) + std::abs(lb)) * own;
  return between_lines(x, alpha, std::min(la - alpha * a, lb - alpha * b) - slack,
                       -std::log(alpha) - 1 + slack, range, library);
}

AffineForm log1p(const AffineForm& the_x) {
  const Settled settled(the_x);
  const AffineForm& x = settled.form();
  const RealInterval range = log1p(x.range);
  const double a = x.range.lo, b = x.range.hi;
  if (!(a > -1) || !std::isfinite(b)) return only_range(range, library);
  const auto f = [](double v) { return Curve{std::log1p(v), 1 / (1 + v)}; };
  const double alpha = b - a > 1e-6 * (1 + a) ? (std::log1p(b) - std::log1p(a)) / (b - a) : 2 / (2 + a + b);
  // The tangent where 1 / (1 + t) = alpha, t kept inside.
  const double t = std::clamp((1 - alpha) / alpha, a, b);
  return concave(x, f, t, alpha, range, library);
}

AffineForm pow(const AffineForm& x, const AffineForm& y) {
  const RealInterval range = pow(x.range, y.range);
  if (!(x.range.lo > 0)) return only_range(range, library);
  // The roundings of log and product, and of exp, are more than those of pow.
  AffineForm out = exp(y * log(x));
  out.range = intersection(out.range, rounded_range(range, library));
  return out;
}

namespace {
bool in_first_quadrant(const AffineForm& x) { return x.range.lo >= 0 && x.range.hi <= 1.5707963267948966; }
}  // namespace

AffineForm sin(const AffineForm& the_x) {
  const Settled settled(the_x);
  const AffineForm& x = settled.form();
  const RealInterval range = sin(x.range);
  if (!in_first_quadrant(x)) return only_range(range, library);
  const double a = x.range.lo, b = x.range.hi;
  const double alpha = b - a > 1e-7 ? (std::sin(b) - std::sin(a)) / (b - a) : std::cos(0.5 * (a + b));
  const double t = std::clamp(std::acos(std::clamp(alpha, -1., 1.)), a, b);
  return concave(
      x,
      [](double v) {
        return Curve{std::sin(v), std::cos(v)};
      },
      t, alpha, range, library);
}
AffineForm cos(const AffineForm& the_x) {
  const Settled settled(the_x);
  const AffineForm& x = settled.form();
  const RealInterval range = cos(x.range);
  if (!in_first_quadrant(x)) return only_range(range, library);
  const double a = x.range.lo, b = x.range.hi;
  const double alpha = b - a > 1e-7 ? (std::cos(b) - std::cos(a)) / (b - a) : -std::sin(0.5 * (a + b));
  const double t = std::clamp(std::asin(std::clamp(-alpha, -1., 1.)), a, b);
  return concave(
      x,
      [](double v) {
        return Curve{std::cos(v), -std::sin(v)};
      },
      t, alpha, range, library);
}
AffineForm acos(const AffineForm& x) { return only_range(acos(x.range), library); }
AffineForm atan2(const AffineForm& y, const AffineForm& x) {
  return only_range(atan2(y.range, x.range), library);
}

AffineForm by_sign(const AffineForm& s, const AffineForm& if_positive, const AffineForm& if_negative) {
  if (s.range.lo > 0) return if_positive;
  if (s.range.hi < 0) return if_negative;
  constexpr double agreement = 0x1p-21;  // 8 roundings
  if (s.range.lo == 0) return widened(if_positive, agreement);
  if (s.range.hi == 0) return widened(if_negative, agreement);
  const Settled settled_a(if_positive), settled_b(if_negative);
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
AffineForm flip_sign(const AffineForm& x, const AffineForm& s) {
  if (s.range.lo >= 0) return x;
  if (s.range.hi <= 0) return -x;
  return by_sign(s, x, -x);
}

AffineForm narrower(const AffineForm& a, const AffineForm& b) {
  AffineForm out = b.error < a.error ? b : a;
  const RealInterval range = intersection(a.range, b.range);
  if (range.lo <= range.hi) out.range = range;
  if (a.log_error < out.log_error)
    out.log_middle = a.log_middle, out.log_slope = a.log_slope, out.log_error = a.log_error;
  if (b.log_error < out.log_error)
    out.log_middle = b.log_middle, out.log_slope = b.log_slope, out.log_error = b.log_error;
  return out;
}
AffineForm widened(const AffineForm& x, double share) {
  const double more = x.range.magnitude() * share;
  AffineForm out = x;
  out.error += more * (1 + own);
  out.range = {x.range.lo - more, x.range.hi + more};
  if (x.range.lo >= 0) out.range.lo = std::max(out.range.lo, 0.);
  out.log_error += share * (1 + share) * (1 + own);
  return out;
}
AffineForm linear_enclosure(const AffineForm& x, double alpha, RealInterval offset, RealInterval range) {
  return between_lines(x, alpha, offset.lo, offset.hi, range, 0);
}

double upper_of_difference(const AffineForm& the_a, double factor, const AffineForm& the_b) {
  const Settled settled_a(the_a), settled_b(the_b);
  const AffineForm &a = settled_a.form(), &b = settled_b.form();
  const double by_range = detail::above(a.range.hi - detail::below(factor * b.range.lo));
  if (!is_known(a) || !is_known(b)) return by_range < detail::infinity ? by_range : detail::infinity;
  double sum = a.middle - factor * b.middle, size = std::abs(a.middle) + std::abs(factor * b.middle);
  for (std::size_t i = 0; i < n; ++i) {
    sum += std::abs(a.slope[i] - factor * b.slope[i]);
    size += std::abs(a.slope[i]) + std::abs(factor * b.slope[i]);
  }
  const double error = a.error + factor * b.error;
  const double by_tube = sum + error + (size + error) * own;
  const double upper = std::min(by_range, by_tube);
  return upper < detail::infinity ? upper : detail::infinity;
}
Slopes slopes_of_difference(const AffineForm& the_a, double factor, const AffineForm& the_b) {
  const Settled settled_a(the_a), settled_b(the_b);
  const AffineForm &a = settled_a.form(), &b = settled_b.form();
  Slopes slope;
  for (std::size_t i = 0; i < n; ++i) slope[i] = a.slope[i] - factor * b.slope[i];
  return slope;
}

}  // namespace reflectree
