// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/affine_form.hpp"

#include "affine_logarithm.hpp"
#include "affine_tube.hpp"

namespace reflectree {

namespace affine {

RealInterval rounded_range(RealInterval r, double unit) {
  RealInterval out{r.lo - (std::abs(r.lo) * unit + flushed), r.hi + (std::abs(r.hi) * unit + flushed)};
  if (r.lo >= 0) out.lo = std::max(out.lo, 0.);
  if (r.hi <= 0) out.hi = std::min(out.hi, 0.);
  // Beyond the largest float lies infinity; NaN comes of infinities alone.
  if (!(out.lo >= -largest_float)) out.lo = -detail::infinity;
  if (!(out.hi <= largest_float)) out.hi = detail::infinity;
  return out;
}

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

void round(AffineForm& out, double error, RealInterval range, double unit) {
  const RealInterval r = rounded_range(range, unit);
  const double radius = radius_of(out.slope);
  const double size = std::min(r.magnitude(), (std::abs(out.middle) + radius + error) * (1 + unit + own));
  complete(out, radius, error + size * unit + flushed, r);
}

AffineForm only_range(RealInterval range, double unit) {
  return AffineForm::anything_in(rounded_range(range, unit));
}

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

}  // namespace affine

using namespace affine;

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
AffineForm with_named_error(const AffineForm& x, std::size_t k) {
  LogForm log = log_of(x);
  if (!(log.error < 1) || !(x.range.lo > 0)) return x;
  // What is left: programs may compute x twice, and round it otherwise.
  log.slope[k] = log.error, log.error = 0x1p-22;
  return exponential(log, RealInterval::whole(), x.range, 0);
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

namespace {
// The same by the logarithm of a / (factor b).
double upper_by_logarithm(const AffineForm& a, double factor, const AffineForm& b) {
  const LogForm log_a = log_of(a), log_b = log_of(b);
  if (!(log_a.error + log_b.error < 1) || !(b.range.lo > 0) || !(a.range.lo > 0)) return detail::infinity;
  double sum = log_a.middle - log_b.middle - std::log(factor);
  for (std::size_t i = 0; i < n; ++i) sum += std::abs(log_a.slope[i] - log_b.slope[i]);
  sum += log_a.error + log_b.error + (log_a.size() + log_b.size() + std::abs(std::log(factor))) * own;
  const double share = std::expm1(sum) * (1 + (sum > 0 ? 8 : -8) * own);
  return factor * (share > 0 ? b.range.hi : b.range.lo) * share;
}
}  // namespace

double upper_of_difference(const AffineForm& the_a, double factor, const AffineForm& the_b) {
  const Settled settled_a(the_a), settled_b(the_b);
  const AffineForm &a = settled_a.form(), &b = settled_b.form();
  const double by_range = detail::above(a.range.hi - detail::below(factor * b.range.lo));
  const double by_log = upper_by_logarithm(the_a, factor, the_b);
  if (!is_known(a) || !is_known(b)) {
    const double known = std::min(by_range, by_log);
    return known < detail::infinity ? known : detail::infinity;
  }
  double sum = a.middle - factor * b.middle, size = std::abs(a.middle) + std::abs(factor * b.middle);
  for (std::size_t i = 0; i < n; ++i) {
    sum += std::abs(a.slope[i] - factor * b.slope[i]);
    size += std::abs(a.slope[i]) + std::abs(factor * b.slope[i]);
  }
  const double error = a.error + factor * b.error;
  const double by_tube = sum + error + (size + error) * own;
  const double upper = std::min({by_range, by_tube, by_log});
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
