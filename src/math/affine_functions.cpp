// SPDX-License-Identifier: Apache-2.0
// Functions of one form, between two lines.
#include "affine_logarithm.hpp"

namespace reflectree {

using namespace affine;

namespace {

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

// sin and cos. place: where, in the arc on which they are concave, the slope is alpha; there, and at the image of
// the place about `centre` of the arc next to it, the distance from a line of that slope is extreme.
template <class Function, class Place>
AffineForm circular(const AffineForm& x, const Function& f, const Place& place, RealInterval concave_in,
                    double centre, RealInterval range) {
  const double a = x.range.lo, b = x.range.hi;
  if (!(b - a < 3)) return only_range(range, library);
  const double alpha = b - a > 1e-7 ? (f(b).value - f(a).value) / (b - a) : f(0.5 * (a + b)).slope;
  if (concave_in.contains(x.range)) {
    return concave(x, f, std::clamp(place(alpha), a, b), alpha, range, library);
  }
  constexpr double turn = 2 * pi_v<double>;
  const double at_a = f(a).value - alpha * a, at_b = f(b).value - alpha * b;
  double low = std::min(at_a, at_b), high = std::max(at_a, at_b);
  for (const double p : {place(alpha), 2 * centre - place(alpha)}) {
    const double t = p + turn * std::ceil((a - p) / turn);
    if (!(t < b)) continue;
    low = std::min(low, f(t).value - alpha * t), high = std::max(high, f(t).value - alpha * t);
  }
  return between_lines(x, alpha, low, high, range, library);
}

}  // namespace

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

AffineForm exp(const AffineForm& the_x) {
  const Settled settled(the_x);
  const AffineForm& x = settled.form();
  const RealInterval range = exp(x.range);
  if (!is_known(x)) return only_range(range, library);
  return exponential({x.middle, x.slope, x.error}, x.range, range, library);
}

// Convex: what lies below its negative.
AffineForm expm1(const AffineForm& the_x) {
  const Settled settled(the_x);
  const AffineForm& x = settled.form();
  const double a = x.range.lo, b = x.range.hi;
  const RealInterval range = {std::max(detail::well_below(std::expm1(a)), -1.),
                              detail::well_above(std::expm1(b))};
  if (!std::isfinite(a) || !(b < 85)) return only_range(range, library);
  const auto f = [](double v) { return Curve{-std::expm1(v), -std::exp(v)}; };
  const double alpha = b - a > 1e-6 ? (std::expm1(b) - std::expm1(a)) / (b - a) : std::exp(0.5 * (a + b));
  return -concave(x, f, std::clamp(std::log(std::max(alpha, 1e-300)), a, b), -alpha, -range, library);
}

AffineForm log(const AffineForm& x) {
  const RealInterval range = log(x.range);
  const double a = x.range.lo, b = x.range.hi;
  if (!(a > 0) || !std::isfinite(b)) return only_range(range, library);
  const auto [la, lb, alpha, low, high] = lines_of_log(a, b);
  const double slack = (1 + std::abs(la) + std::abs(lb)) * own;
  return between_lines(x, alpha, low - slack, high + slack, range, library);
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

AffineForm sin(const AffineForm& the_x) {
  const Settled settled(the_x);
  const auto f = [](double v) { return Curve{std::sin(v), std::cos(v)}; };
  const auto place = [](double slope) { return std::acos(std::clamp(slope, -1., 1.)); };
  return circular(settled.form(), f, place, {0, 3.1415926535897931}, 0, sin(settled.form().range));
}
AffineForm cos(const AffineForm& the_x) {
  const Settled settled(the_x);
  const auto f = [](double v) { return Curve{std::cos(v), -std::sin(v)}; };
  const auto place = [](double slope) { return std::asin(std::clamp(-slope, -1., 1.)); };
  return circular(settled.form(), f, place, {-1.5707963267948966, 1.5707963267948966}, 1.5707963267948966,
                  cos(settled.form().range));
}
AffineForm asinh(const AffineForm& the_x) {
  const Settled settled(the_x);
  const AffineForm& x = settled.form();
  const double a = x.range.lo, b = x.range.hi;
  const RealInterval range = detail::ascending([](double v) { return std::asinh(v); }, x.range);
  if (!is_known(x) || !std::isfinite(a) || !std::isfinite(b)) return only_range(range, library);
  const auto f = [](double v) { return std::asinh(v); };
  const double alpha = b - a > 1e-7 * (1 + std::abs(a)) ? (f(b) - f(a)) / (b - a) : 1 / std::hypot(1, a);
  double low = std::min(f(a) - alpha * a, f(b) - alpha * b),
         high = std::max(f(a) - alpha * a, f(b) - alpha * b);
  // Where its slope, 1 / sqrt(1 + t^2), is alpha.
  const double place = std::sqrt(std::max(1 / (alpha * alpha) - 1, 0.));
  for (const double t : {std::clamp(place, a, b), std::clamp(-place, a, b)})
    low = std::min(low, f(t) - alpha * t), high = std::max(high, f(t) - alpha * t);
  const double slack = (1 + std::abs(f(a)) + std::abs(f(b))) * own;
  return between_lines(x, alpha, low - slack, high + slack, range, library);
}
AffineForm acos(const AffineForm& x) { return only_range(acos(x.range), library); }

namespace {
// Between lines through the extremes of atan t - alpha t: at the ends, and where 1 / (1 + t^2) is alpha.
AffineForm arc_tangent(const AffineForm& the_x) {
  const Settled settled(the_x);
  const AffineForm& x = settled.form();
  const double a = x.range.lo, b = x.range.hi;
  const RealInterval range{std::atan(a), std::atan(b)};
  if (!std::isfinite(a) || !std::isfinite(b)) return only_range(range, library);
  const double alpha =
      b - a > 1e-6 * (1 + std::abs(a)) ? (range.hi - range.lo) / (b - a) : 1 / (1 + 0.25 * sqr(a + b));
  const double turn = std::sqrt(std::max(1 / alpha - 1, 0.));
  double low = detail::infinity, high = -detail::infinity;
  for (const double t : {a, b, std::clamp(turn, a, b), std::clamp(-turn, a, b)}) {
    const double off = std::atan(t) - alpha * t;
    low = std::min(low, off), high = std::max(high, off);
  }
  // An extreme that rounding moves is missed by less than doubles round.
  return between_lines(x, alpha, low, high, range, library);
}
}  // namespace

// By the ratio that is less than 1, or has a divisor that does not hold 0.
AffineForm atan2(const AffineForm& y, const AffineForm& x) {
  const RealInterval range = atan2(y.range, x.range);
  const bool y_may = y.range.lo > 0 || y.range.hi < 0;
  const bool by_x = x.range.lo > 0 && (!y_may || std::abs(x.range.middle()) >= std::abs(y.range.middle()));
  if (!by_x && !y_may) return only_range(range, library);
  AffineForm out;
  if (by_x) {
    out = arc_tangent(y / x);
  } else {
    const AffineForm right_angle(0.5 * pi_v<double>);
    out = (y.range.lo > 0 ? right_angle : -right_angle) - arc_tangent(x / y);
  }
  const RealInterval known = intersection(out.range, rounded_range(range, library));
  if (known.lo <= known.hi) out.range = known;
  return out;
}

}  // namespace reflectree
