// SPDX-License-Identifier: Apache-2.0
// Intervals of doubles, rounded outwards: whatever numbers stand in the operands, the exact result stands in
// the interval. No rounding mode is switched (WebAssembly has none): a rounded result is moved by at least half
// an ulp. Rump, Zimmermann, Boldo, Melquiond 2009, "Computing predecessor and successor in rounding to
// nearest", BIT 49.
//
//   operation                        enclosure, beyond the exact range at each end
//   + - * / sqr sqrt                 at most 2 ulp
//   abs min max hull -               nothing
//   exp log log1p pow sin cos tan    10 ulp; assumes that the C library errs by less than 4 ulp
//   asin acos atan2                  likewise
//
// sin, cos, tan of more than 1e5 radians, and tan across a pole, are all that the function takes. A divisor that
// holds 0 gives the whole line. A function that is undefined in a part of its operand speaks of the other part.
// tests/math/interval_test.cpp measures every row beside MPFI.
#pragma once

#include <algorithm>
#include <limits>

#include "reflectree/math/scalar.hpp"

namespace reflectree {

namespace detail {
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double largest_double = std::numeric_limits<double>::max();

// A double that is at most (at least) every real number that rounds to x.
constexpr double below(double x) {
  if (x == infinity) return largest_double;
  const double size = x < 0 ? -x : x;
  return x - (size * 0x1.0000000000001p-53 + 0x1p-1074);
}
constexpr double above(double x) { return -below(-x); }
// The same for results of the C library.
inline double well_below(double x) {
  return x == infinity ? largest_double : x - (std::abs(x) * 0x1p-50 + 0x1p-1070);
}
inline double well_above(double x) { return -well_below(-x); }
}  // namespace detail

// All numbers from lo to hi; ends may be infinite. Never empty, never NaN.
struct RealInterval {
  double lo = 0, hi = 0;

  constexpr RealInterval() = default;
  // A number as it stands; long double constants are enclosed.
  template <class A>
  requires std::is_arithmetic_v<A>
  constexpr explicit RealInterval(A number) : lo(double(number)), hi(double(number)) {
    if (static_cast<long double>(lo) != static_cast<long double>(number))
      lo = detail::below(lo), hi = detail::above(hi);
  }
  constexpr RealInterval(double a, double b) : lo(a), hi(b) {}
  static constexpr RealInterval whole() { return {-detail::infinity, detail::infinity}; }

  constexpr double middle() const { return 0.5 * lo + 0.5 * hi; }
  constexpr double magnitude() const { return std::max(lo < 0 ? -lo : lo, hi < 0 ? -hi : hi); }
  constexpr bool contains(double x) const { return lo <= x && x <= hi; }
  constexpr bool contains(RealInterval x) const { return lo <= x.lo && x.hi <= hi; }
  friend constexpr bool operator==(RealInterval, RealInterval) = default;

  friend constexpr RealInterval operator-(RealInterval a) { return {-a.hi, -a.lo}; }
  friend constexpr RealInterval operator+(RealInterval a, RealInterval b) {
    return {detail::below(a.lo + b.lo), detail::above(a.hi + b.hi)};
  }
  friend constexpr RealInterval operator-(RealInterval a, RealInterval b) { return a + -b; }
  friend constexpr RealInterval operator*(RealInterval a, RealInterval b) {
    // 0 times an infinite end: no member is infinite, so the product is 0.
    const auto times = [](double x, double y) { return x == 0 || y == 0 ? 0 : x * y; };
    const double p = times(a.lo, b.lo), q = times(a.lo, b.hi), r = times(a.hi, b.lo), s = times(a.hi, b.hi);
    const double lo = std::min(std::min(p, q), std::min(r, s)), hi = std::max(std::max(p, q), std::max(r, s));
    // The sign of a product is exact.
    const bool positive = (a.lo >= 0 && b.lo >= 0) || (a.hi <= 0 && b.hi <= 0);
    const bool negative = (a.lo >= 0 && b.hi <= 0) || (a.hi <= 0 && b.lo >= 0);
    return {positive ? std::max(detail::below(lo), 0.) : detail::below(lo),
            negative ? std::min(detail::above(hi), 0.) : detail::above(hi)};
  }
  friend constexpr RealInterval operator/(RealInterval a, RealInterval b) {
    if (b.lo <= 0 && b.hi >= 0) {
      // One-sided: the sign is known where that of the dividend is.
      if (b.lo == 0 && b.hi > 0 && a.lo >= 0) return {0, detail::infinity};
      return whole();
    }
    const RealInterval inverse{detail::below(1 / b.hi), detail::above(1 / b.lo)};
    const auto quotient = [](double x, double y) {
      const bool both = (x == detail::infinity || x == -detail::infinity) &&
                        (y == detail::infinity || y == -detail::infinity);
      return both ? 0 : x / y;
    };
    const double p = quotient(a.lo, b.lo), q = quotient(a.lo, b.hi), r = quotient(a.hi, b.lo),
                 s = quotient(a.hi, b.hi);
    RealInterval out{detail::below(std::min(std::min(p, q), std::min(r, s))),
                     detail::above(std::max(std::max(p, q), std::max(r, s)))};
    if ((a.lo >= 0 && inverse.lo >= 0) || (a.hi <= 0 && inverse.hi <= 0)) out.lo = std::max(out.lo, 0.);
    if ((a.lo >= 0 && inverse.hi <= 0) || (a.hi <= 0 && inverse.lo >= 0)) out.hi = std::min(out.hi, 0.);
    return out;
  }
};

constexpr RealInterval hull(RealInterval a, RealInterval b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}
// What both hold; two enclosures of one number share it.
constexpr RealInterval intersection(RealInterval a, RealInterval b) {
  return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
}
constexpr RealInterval min(RealInterval a, RealInterval b) {
  return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}
constexpr RealInterval max(RealInterval a, RealInterval b) {
  return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
}
constexpr RealInterval abs(RealInterval a) {
  if (a.lo >= 0) return a;
  return a.hi <= 0 ? -a : RealInterval{0, std::max(-a.lo, a.hi)};
}
constexpr RealInterval sqr(RealInterval a) {
  const RealInterval b = abs(a);
  return {std::max(detail::below(b.lo * b.lo), 0.), detail::above(b.hi * b.hi)};
}
inline RealInterval sqrt(RealInterval a) {
  const double lo = a.lo > 0 ? std::max(detail::below(std::sqrt(a.lo)), 0.) : 0;
  return {lo, a.hi > 0 ? detail::above(std::sqrt(a.hi)) : 0};
}
// The form of by_sign of floats: the first where s has no minus sign, the second where it has.
constexpr RealInterval by_sign(RealInterval s, RealInterval if_positive, RealInterval if_negative) {
  if (s.lo > 0) return if_positive;
  return s.hi < 0 ? if_negative : hull(if_positive, if_negative);
}
constexpr RealInterval flip_sign(RealInterval x, RealInterval s) { return by_sign(s, x, -x); }

namespace detail {
// A function that ascends, rounded by the C library, with values in [least, most].
template <class Function>
RealInterval ascending(const Function& f, RealInterval a, double least = -infinity, double most = infinity) {
  return {std::max(well_below(f(a.lo)), least), std::min(well_above(f(a.hi)), most)};
}
// Whether [a] may hold a number offset + k step.
inline bool may_hold(RealInterval a, double offset, double step) {
  const double slack = 1e-9;
  return std::floor((a.hi - offset) / step + slack) > std::ceil((a.lo - offset) / step - slack) - 0.5;
}
inline bool is_small_angle(RealInterval a) { return a.lo >= -1e5 && a.hi <= 1e5; }
}  // namespace detail

inline RealInterval exp(RealInterval a) {
  return detail::ascending([](double x) { return std::exp(x); }, a, 0.);
}
inline RealInterval log(RealInterval a) {
  return detail::ascending([](double x) { return x > 0 ? std::log(x) : -detail::infinity; }, a);
}
inline RealInterval log1p(RealInterval a) {
  return detail::ascending([](double x) { return x > -1 ? std::log1p(x) : -detail::infinity; }, a);
}
// x >= 0. The exponent of e is y log x: its extremes are at the corners.
inline RealInterval pow(RealInterval x, RealInterval y) {
  const double a = std::max(x.lo, 0.), b = std::max(x.hi, 0.);
  const double p = std::pow(a, y.lo), q = std::pow(a, y.hi), r = std::pow(b, y.lo), s = std::pow(b, y.hi);
  return {std::max(detail::well_below(std::min(std::min(p, q), std::min(r, s))), 0.),
          detail::well_above(std::max(std::max(p, q), std::max(r, s)))};
}
inline RealInterval cos(RealInterval a) {
  if (!detail::is_small_angle(a)) return {-1, 1};
  const double p = std::cos(a.lo), q = std::cos(a.hi);
  return {detail::may_hold(a, pi_v<double>, 2 * pi_v<double>)
              ? -1
              : std::max(detail::well_below(std::min(p, q)), -1.),
          detail::may_hold(a, 0, 2 * pi_v<double>) ? 1 : std::min(detail::well_above(std::max(p, q)), 1.)};
}
inline RealInterval sin(RealInterval a) {
  if (!detail::is_small_angle(a)) return {-1, 1};
  const double p = std::sin(a.lo), q = std::sin(a.hi);
  return {detail::may_hold(a, 1.5 * pi_v<double>, 2 * pi_v<double>)
              ? -1
              : std::max(detail::well_below(std::min(p, q)), -1.),
          detail::may_hold(a, 0.5 * pi_v<double>, 2 * pi_v<double>)
              ? 1
              : std::min(detail::well_above(std::max(p, q)), 1.)};
}
inline RealInterval tan(RealInterval a) {
  if (!detail::is_small_angle(a) || detail::may_hold(a, 0.5 * pi_v<double>, pi_v<double>)) {
    return RealInterval::whole();
  }
  return detail::ascending([](double x) { return std::tan(x); }, a);
}
inline RealInterval asin(RealInterval a) {
  return detail::ascending([](double x) { return std::asin(std::clamp(x, -1., 1.)); }, a);
}
inline RealInterval acos(RealInterval a) {
  const auto f = [](double x) { return std::acos(std::clamp(x, -1., 1.)); };
  return {std::max(detail::well_below(f(a.hi)), 0.), detail::well_above(f(a.lo))};
}
// In [-pi, pi]. Away from the origin and the negative x axis the extremes are at the corners.
inline RealInterval atan2(RealInterval y, RealInterval x) {
  constexpr double most = 3.14159265358979356;  // the double above pi
  const bool around = y.lo <= 0 && y.hi >= 0;
  if (around && x.lo <= 0) return y.lo == 0 ? RealInterval{0, most} : RealInterval{-most, most};
  double lo = detail::infinity, hi = -detail::infinity;
  for (const double b : {y.lo, y.hi}) {
    for (const double a : {x.lo, x.hi})
      lo = std::min(lo, std::atan2(b, a)), hi = std::max(hi, std::atan2(b, a));
  }
  return {std::max(detail::well_below(lo), -most), std::min(detail::well_above(hi), most)};
}
inline bool isfinite(RealInterval a) { return std::isfinite(a.lo) && std::isfinite(a.hi); }

}  // namespace reflectree
