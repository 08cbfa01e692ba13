// SPDX-License-Identifier: Apache-2.0
#include "affine_logarithm.hpp"

namespace reflectree::affine {

LinesOfLog lines_of_log(double a, double b) {
  const double log_a = std::log(a), log_b = std::log(b);
  const double alpha = b > a * (1 + 1e-6) ? (log_b - log_a) / (b - a) : 2 / (a + b);
  // log x - alpha x is largest at 1 / alpha.
  return {log_a, log_b, alpha, std::min(log_a - alpha * a, log_b - alpha * b), -std::log(alpha) - 1};
}

LogForm log_of(const AffineForm& x) {
  const double sign = x.range.hi < 0 ? -1 : 1;
  const double a = sign > 0 ? x.range.lo : -x.range.hi, b = sign > 0 ? x.range.hi : -x.range.lo;
  LogForm out = kept_log(x);
  // About what the lines would add: a sixteenth of the square of the range's width.
  if (is_log_known(x) && !((x.error + 0.1 * (b - a) * (b - a) / a) < 0.7 * x.log_error * a)) return out;
  out = {0, {}, detail::infinity};
  if (!(a > 1e-35) || !(b < 8 * a) || !is_known(x)) return out;
  const auto [la, lb, alpha, low, high] = lines_of_log(a, b);
  out.middle = sign * alpha * x.middle + 0.5 * (low + high);
  for (std::size_t i = 0; i < n; ++i) out.slope[i] = sign * alpha * x.slope[i];
  out.error = alpha * x.error + 0.5 * std::max(high - low, 0.) + (4 + std::abs(la) + std::abs(lb)) * own;
  return out;
}

void add_log(AffineForm& x, const LogForm& a, double sign, const LogForm& b, double unit) {
  // Below this the underflow counts.
  const double least = std::max(x.range.lo, -x.range.hi);
  if (!(a.error + b.error < 3) || !(least > 1e-30)) return;
  x.log_middle = a.middle + sign * b.middle;
  for (std::size_t i = 0; i < n; ++i) x.log_slope[i] = a.slope[i] + sign * b.slope[i];
  x.log_error = a.error + b.error + 1.001 * unit + flushed / least + (a.size() + b.size()) * own;
}

namespace {
bool is_slack(const AffineForm& a) { return radius_of(a.slope) == 0 && a.range.contains(0); }
}  // namespace

void add_log_of_sum(AffineForm& out, const AffineForm& a, double sign, const AffineForm& b, double unit) {
  const double slack = b.range.magnitude(), least = std::max(a.range.lo, -a.range.hi);
  if (is_log_known(a) && is_slack(b) && slack < 0.1 * least) {
    const LogForm log{0, {}, slack / (least - slack) * (1 + own)};
    add_log(out, kept_log(a), 1, log, unit);
    return;
  }
  if (sign < 0 || !(a.range.lo > 0) || !(b.range.lo > 0) || (!is_log_known(a) && !is_log_known(b))) return;
  const LogForm log_a = log_of(a), log_b = log_of(b);
  if (!(log_a.error + log_b.error < 3)) return;
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

AffineForm turned_around(const AffineForm& x) {
  AffineForm out = x;
  out.middle = -x.middle, out.range = -x.range;
  for (double& v : out.slope) v = -v;
  return out;
}

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

}  // namespace reflectree::affine
