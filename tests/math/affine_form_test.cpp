// SPDX-License-Identifier: Apache-2.0
// Affine forms hold what programs return: formulas over random boxes, evaluated inside in float and in long
// double.
#include "reflectree/math/affine_form.hpp"

#include <gtest/gtest.h>

#include <string>

#include "reflectree/math/fast_functions.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

constexpr std::size_t n = 3;  // of the variables every other one
static_assert(2 * n <= AffineForm::variables);
using Point = std::array<double, n>;  // in [-1, 1]

// Formulas of x in [-1, 1], y in [-3, 3], p in [0.01, 5] and q = (x + 1) 3/4, as models have them.
struct Formula {
  template <class T>
  struct In {
    T x, y, p, q;
  };
  std::string name;
  AffineForm (*form)(const In<AffineForm>&);
  float (*single)(const In<float>&);
  long double (*exact)(const In<long double>&);
};
#define REFLECTREE_FORMULA(expression)                                                        \
  Formula {                                                                                   \
#expression, [](const Formula::In<AffineForm>& v) {                                         \
      using T = AffineForm;                                                                   \
      const T &x = v.x, &y = v.y, &p = v.p, &q = v.q;                                         \
      static_cast<void>(x), static_cast<void>(y), static_cast<void>(p), static_cast<void>(q); \
      return expression;                                                                      \
    },                                                                                        \
        [](const Formula::In<float>& v) {                                                     \
          using T = float;                                                                    \
          const T x = v.x, y = v.y, p = v.p, q = v.q;                                         \
          static_cast<void>(x), static_cast<void>(y), static_cast<void>(p), static_cast<void>(q); \
          return T(expression);                                                               \
        },                                                                                    \
        [](const Formula::In<long double>& v) {                                               \
          using T = long double;                                                              \
          const T x = v.x, y = v.y, p = v.p, q = v.q;                                         \
          static_cast<void>(x), static_cast<void>(y), static_cast<void>(p), static_cast<void>(q); \
          return T(expression);                                                               \
        } \
  }

std::vector<Formula> formulas() {
  return {REFLECTREE_FORMULA(x + y),
          REFLECTREE_FORMULA(x - x * y),
          REFLECTREE_FORMULA(x * y * p),
          REFLECTREE_FORMULA(sqr(x) * sqr(y) + sqr(y - x)),
          REFLECTREE_FORMULA(x / p + T(0.1) / (p * p)),
          REFLECTREE_FORMULA(y / (T(-7) + x)),
          REFLECTREE_FORMULA(sqrt(sqr(x) + T(0.01) * p)),
          REFLECTREE_FORMULA(sqrt(max(y, T(0)))),
          REFLECTREE_FORMULA(abs(x) + abs(y - x)),
          REFLECTREE_FORMULA(max(x, y) - min(x * y, p)),
          REFLECTREE_FORMULA(clamp(y, x, p + T(2))),
          REFLECTREE_FORMULA(exp(y)),
          REFLECTREE_FORMULA(exp(T(-20) * p)),
          REFLECTREE_FORMULA(log(p) + log1p(T(0.99) * x)),
          REFLECTREE_FORMULA(exp(T(30) * log1p(-min(q, T(0.9))))),
          REFLECTREE_FORMULA(pow(p, y)),
          REFLECTREE_FORMULA(sin(q) * cos(q)),
          REFLECTREE_FORMULA(acos(T(0.9) * x)),
          REFLECTREE_FORMULA(atan2(p, q) + atan2(y, -p)),
          REFLECTREE_FORMULA(atan2(x, p) - atan2(-p, y)),
          REFLECTREE_FORMULA(sqr(T(0.1)) / (pi_v<T> * sqr(sqr(x) + sqr(T(0.1) * q)) + T(1e-3))),
          REFLECTREE_FORMULA(cos_sin_half(x).x * cos_sin_half(x).y)};
}

AffineForm variable(std::size_t k, RealInterval range) {
  return AffineForm::variable(2 * k, range.lo, range.hi);
}

struct Box {
  std::array<RealInterval, n> range;
  Formula::In<AffineForm> forms() const {
    const AffineForm x = variable(0, range[0]);
    return {x, variable(1, range[1]), variable(2, range[2]), (x + AffineForm(1)) * AffineForm(0.75)};
  }
};
Box random_box(Pcg32& u) {
  constexpr RealInterval whole[n] = {{-1, 1}, {-3, 3}, {0.01, 5}};
  const double share = std::pow(2., -12 * to_unit_double(u()));
  Box box;
  for (std::size_t k = 0; k < n; ++k) {
    const double width = share * (whole[k].hi - whole[k].lo);
    const double lo = whole[k].lo + to_unit_double(u()) * (whole[k].hi - whole[k].lo - width);
    // Through memory: g++ 12 leaves out the rounding of a pair that it keeps in a vector register.
    volatile float from = float(lo), to = float(lo + width);
    box.range[k] = {double(from), double(to)};
  }
  return box;
}

bool holds(const AffineForm& form, const Point& e, long double value) {
  if (!form.range.contains(double(value))) return false;
  if (form.error == detail::infinity) return true;
  long double line = form.middle;
  for (std::size_t k = 0; k < n; ++k) line += static_cast<long double>(form.slope[2 * k]) * e[k];
  return std::abs(value - line) <= form.error * (1 + 1e-12L);
}

// How many of the values at random points of random boxes the forms miss.
template <class Tamper>
std::size_t missed(const Formula& formula, std::uint64_t seed, int boxes, const Tamper& tamper) {
  Pcg32 u(seed);
  std::size_t count = 0;
  for (int i = 0; i < boxes; ++i) {
    const Box box = random_box(u);
    const AffineForm form = tamper(formula.form(box.forms()));
    for (int k = 0; k < 12; ++k) {
      Point e{};
      std::array<float, n> at{};
      for (std::size_t a = 0; a < n; ++a) {
        const double t = k < 6 ? to_unit_double(u()) : double(u() & 1U);  // inside and at corners
        at[a] = float(box.range[a].lo + t * (box.range[a].hi - box.range[a].lo));
        const double radius = 0.5 * (box.range[a].hi - box.range[a].lo);
        e[a] = std::clamp((double(at[a]) - box.range[a].middle()) / radius, -1., 1.);
      }
      const Formula::In<float> f{at[0], at[1], at[2], (at[0] + 1) * 0.75f};
      const Formula::In<long double> d{at[0], at[1], at[2], (at[0] + 1.L) * 0.75L};
      count += !holds(form, e, formula.single(f)) + !holds(form, e, formula.exact(d));
    }
  }
  return count;
}

TEST(AffineForm, HoldsFloatsAndRealNumbers) {
  for (const Formula& formula : formulas()) {
    EXPECT_EQ(missed(formula, 3, 3000, [](AffineForm f) { return f; }), 0U) << formula.name;
  }
}

TEST(AffineFormTwin, WrongFormsAreFound) {
  const auto narrower = [](AffineForm f) {
    f.error *= 0.5, f.range = RealInterval::whole();
    return f;
  };
  const auto no_rounding = [](AffineForm f) {
    f.error = std::max(0., f.error - 2 * std::abs(f.middle) * 0x1p-24), f.range = RealInterval::whole();
    return f;
  };
  const auto other_sign = [](AffineForm f) {
    f.slope[0] = -f.slope[0], f.range = RealInterval::whole();
    return f;
  };
  std::size_t found = 0;
  for (const Formula& formula : formulas()) found += missed(formula, 3, 3000, narrower) > 0;
  EXPECT_GE(found, formulas().size() / 2) << "half of the tubes are narrower than twice what they must be";
  const Formula sum = formulas().front();
  EXPECT_GT(missed(sum, 3, 3000, no_rounding), 0U);
  EXPECT_GT(missed(sum, 3, 3000, other_sign), 0U);
}

// The tube closes in with the square of the width of the box, until the roundings of floats are left.
TEST(AffineForm, ErrorFallsWithTheSquareOfTheWidth) {
  for (const Formula& formula : formulas()) {
    if (formula.name.find("abs") != std::string::npos || formula.name.find("max") != std::string::npos ||
        formula.name.find("clamp") != std::string::npos || formula.name.find("acos") != std::string::npos)
      continue;  // kinks, and ranges alone
    const auto error_at = [&](double width) {
      Box box;
      const Point centre{0.4, 1.1, 0.8};
      for (std::size_t k = 0; k < n; ++k) box.range[k] = {centre[k] - 0.5 * width, centre[k] + 0.5 * width};
      return formula.form(box.forms()).error;
    };
    EXPECT_LT(error_at(0.02), 0.3 * error_at(0.04) + 1e-5) << formula.name;
  }
}

TEST(AffineForm, UpperOfDifference) {
  const AffineForm x = AffineForm::variable(0, 1, 2), y = x + AffineForm(0.25);
  EXPECT_GE(upper_of_difference(x, 1, y), -0.25);
  EXPECT_LT(upper_of_difference(x, 1, y), -0.2499) << "what both share cancels";
  EXPECT_EQ(upper_of_difference(AffineForm::anything_in(RealInterval::whole()), 1, y), detail::infinity);
}

TEST(AffineForm, WhatMayLeaveTheRangeOfFloatIsInfinite) {
  const AffineForm large = AffineForm::variable(0, 1, 2e38);
  EXPECT_EQ((large * AffineForm(4.f)).range.hi, detail::infinity);
  EXPECT_EQ((AffineForm(1.f) / AffineForm::variable(0, -1, 1)).range, RealInterval::whole());
  const AffineForm vanishing = exp(AffineForm(50.f) * log1p(-AffineForm::variable(0, 0.5, 1)));
  EXPECT_GE(vanishing.range.lo, 0);
  EXPECT_LT(vanishing.range.hi, 1e-14);
}

// What a form owes to the error of a step is a variable: it holds the step's values, and cancels.
int outside_of_named(double share) {
  Pcg32 u(31);
  int outside = 0;
  for (int i = 0; i < 2000; ++i) {
    const double width = 0.2 + 0.5 * to_unit_double(u());
    const AffineForm x = AffineForm::variable(0, 1, 1 + width), y = AffineForm::variable(2, 2, 2 + width);
    AffineForm named = with_named_error(x * x + exp(y) * sqrt(x), 7);
    named.log_slope[7] *= share;
    const AffineForm cancelled = named * named / named;
    for (int k = 0; k < 20; ++k) {
      const double a = to_unit_double(u()), b = to_unit_double(u()), vx = 1 + width * a, vy = 2 + width * b;
      const double value = vx * vx + std::exp(vy) * std::sqrt(vx);
      const double line =
          cancelled.log_middle + cancelled.log_slope[0] * (2 * a - 1) + cancelled.log_slope[2] * (2 * b - 1);
      outside += std::abs(std::log(value) - line) > std::abs(cancelled.log_slope[7]) + cancelled.log_error;
    }
    EXPECT_LT(cancelled.log_error, 1e-5);
    EXPECT_NEAR(cancelled.log_slope[7], named.log_slope[7], 1e-9);
  }
  return outside;
}
TEST(AffineForm, NamedErrorsHoldAndCancel) { EXPECT_EQ(outside_of_named(1), 0); }
TEST(AffineFormTwin, ANamedErrorThatIsTooSmallIsFound) { EXPECT_GT(outside_of_named(0.25), 0); }

}  // namespace
}  // namespace reflectree
