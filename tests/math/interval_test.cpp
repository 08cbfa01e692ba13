// SPDX-License-Identifier: Apache-2.0
// Every operation of RealInterval beside MPFI (Revol and Rouillier 2005) in 200 bits, at random boxes. What the test
// can see: the same boxes reject enclosures that lack the last rounding, or an extreme inside.
#include "reflectree/math/interval.hpp"

#include <gtest/gtest.h>
#include <mpfi.h>

#include <cstdlib>
#include <functional>
#include <string>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

struct Multi {
  mpfi_t v;
  Multi() { mpfi_init2(v, 200); }
  explicit Multi(RealInterval a) : Multi() { mpfi_interv_d(v, a.lo, a.hi); }
  ~Multi() { mpfi_clear(v); }
  Multi(const Multi&) = delete;
  Multi& operator=(const Multi&) = delete;
};

using Unary = std::function<RealInterval(RealInterval)>;
using Binary = std::function<RealInterval(RealInterval, RealInterval)>;
struct Row {
  std::string name;
  Binary ours;
  std::function<void(mpfi_ptr, mpfi_srcptr, mpfi_srcptr)> oracle;
  double lo, hi;  // of operands; positive lo: spread over octaves
  int ulps;       // stated excess at each end, in ulp
  bool two = false;
  double lo2 = 0, hi2 = 0;
};

Binary one(Unary f) {
  return [f](RealInterval a, RealInterval) { return f(a); };
}
std::function<void(mpfi_ptr, mpfi_srcptr, mpfi_srcptr)> one(int (*f)(mpfi_ptr, mpfi_srcptr)) {
  return [f](mpfi_ptr out, mpfi_srcptr a, mpfi_srcptr) { f(out, a); };
}
std::function<void(mpfi_ptr, mpfi_srcptr, mpfi_srcptr)> two(int (*f)(mpfi_ptr, mpfi_srcptr, mpfi_srcptr)) {
  return [f](mpfi_ptr out, mpfi_srcptr a, mpfi_srcptr b) { f(out, a, b); };
}
void power(mpfi_ptr out, mpfi_srcptr x, mpfi_srcptr y) {
  mpfi_log(out, x);
  mpfi_mul(out, out, y);
  mpfi_exp(out, out);
}
void larger(mpfi_ptr out, mpfi_srcptr a, mpfi_srcptr b) {
  mpfr_max(&out->left, &a->left, &b->left, MPFR_RNDD);
  mpfr_max(&out->right, &a->right, &b->right, MPFR_RNDU);
}
void smaller(mpfi_ptr out, mpfi_srcptr a, mpfi_srcptr b) {
  mpfr_min(&out->left, &a->left, &b->left, MPFR_RNDD);
  mpfr_min(&out->right, &a->right, &b->right, MPFR_RNDU);
}

std::vector<Row> rows() {
  using I = RealInterval;
  std::vector<Row> all{
      {"add", [](I a, I b) { return a + b; }, two(mpfi_add), -10, 10, 2, true, -10, 10},
      {"subtract", [](I a, I b) { return a - b; }, two(mpfi_sub), -10, 10, 2, true, -10, 10},
      {"multiply", [](I a, I b) { return a * b; }, two(mpfi_mul), -10, 10, 2, true, -10, 10},
      {"divide", [](I a, I b) { return a / b; }, two(mpfi_div), -10, 10, 2, true, 1e-9, 10},
      {"divide by negative", [](I a, I b) { return a / -b; },
       [](mpfi_ptr out, mpfi_srcptr a, mpfi_srcptr b) { mpfi_neg(out, b), mpfi_div(out, a, out); }, -10, 10,
       2, true, 1e-9, 10},
      {"sqr", one([](I a) { return sqr(a); }), one(mpfi_sqr), -10, 10, 2},
      {"sqrt", one([](I a) { return sqrt(a); }), one(mpfi_sqrt), 1e-12, 1e12, 2},
      {"abs", one([](I a) { return abs(a); }), one(mpfi_abs), -10, 10, 0},
      {"min", [](I a, I b) { return min(a, b); }, smaller, -10, 10, 0, true, -10, 10},
      {"max", [](I a, I b) { return max(a, b); }, larger, -10, 10, 0, true, -10, 10},
      {"exp", one([](I a) { return exp(a); }), one(mpfi_exp), -80, 80, 10},
      {"log", one([](I a) { return log(a); }), one(mpfi_log), 1e-12, 1e12, 10},
      {"log1p", one([](I a) { return log1p(a); }), one(mpfi_log1p), -0.999, 10, 10},
      {"pow", [](I a, I b) { return pow(a, b); }, power, 1e-6, 100, 10, true, -3, 3},
      {"sin", one([](I a) { return sin(a); }), one(mpfi_sin), -20, 20, 10},
      {"cos", one([](I a) { return cos(a); }), one(mpfi_cos), -20, 20, 10},
      {"tan", one([](I a) { return tan(a); }), one(mpfi_tan), -1.57, 1.57, 10},
      {"asin", one([](I a) { return asin(a); }), one(mpfi_asin), -1, 1, 10},
      {"acos", one([](I a) { return acos(a); }), one(mpfi_acos), -1, 1, 10},
      {"atan2", [](I a, I b) { return atan2(a, b); }, two(mpfi_atan2), -10, 10, 10, true, 1e-6, 10},
      {"atan2 of negative x", [](I a, I b) { return atan2(abs(a), -b); },
       [](mpfi_ptr out, mpfi_srcptr a, mpfi_srcptr b) {
         Multi x, y;
         mpfi_neg(x.v, b), mpfi_abs(y.v, a), mpfi_atan2(out, y.v, x.v);
       },
       0.1, 10, 10, true, 1e-6, 10},
  };
  return all;
}

double between(double lo, double hi, Pcg32& u) {
  const double t = to_unit_double(u());
  return lo > 0 ? lo * std::pow(hi / lo, t) : lo + (hi - lo) * t;
}
// From points to wide boxes.
RealInterval random_box(double lo, double hi, Pcg32& u) {
  const double a = between(lo, hi, u);
  switch (u() % 4) {
    case 0:
      return {a, a};
    case 1:
      return {std::max(a - std::abs(a) * 1e-12, lo), std::min(a + std::abs(a) * 1e-12, hi)};
    case 2: {
      const double r = (hi - lo) * std::pow(10, -6 * to_unit_double(u()));
      return {std::max(a - r, lo), std::min(a + r, hi)};
    }
    default: {
      const double b = between(lo, hi, u);
      return {std::min(a, b), std::max(a, b)};
    }
  }
}

// How far `ours` reaches beyond the oracle's end, in ulp of that end; negative: it does not hold it.
double excess(mpfr_srcptr end, double ours, bool lower) {
  const int order = mpfr_cmp_d(end, ours);
  if (order == 0) return 0;
  const bool outside = lower ? order > 0 : order < 0;
  if (!outside) return -1;
  const double near = mpfr_get_d(end, MPFR_RNDN), ulp = std::max(std::abs(near) * 0x1p-52, 0x1p-1022);
  return std::abs(near - ours) / ulp;
}

struct Judgement {
  std::size_t missed = 0;
  double excess = 0;  // the largest, in ulp
};
Judgement judge(const Row& row, std::size_t boxes, std::uint64_t seed) {
  Judgement out;
  Pcg32 u(seed);
  for (std::size_t i = 0; i < boxes; ++i) {
    const RealInterval a = random_box(row.lo, row.hi, u),
                       b = row.two ? random_box(row.lo2, row.hi2, u) : RealInterval();
    const RealInterval ours = row.ours(a, b);
    const Multi x(a), y(b);
    Multi truth;
    row.oracle(truth.v, x.v, y.v);
    const double lo = excess(&truth.v->left, ours.lo, true), hi = excess(&truth.v->right, ours.hi, false);
    // A double cannot be nearer than the oracle's own last bits.
    if (lo < 0 || hi < 0) ++out.missed;
    out.excess = std::max({out.excess, lo, hi});
  }
  return out;
}

// A test of the long tier looks at ten million boxes per function.
std::size_t box_count() {
  const char* wanted = std::getenv("REFLECTREE_BOXES");
  return wanted ? std::size_t(std::strtoull(wanted, nullptr, 10)) : 20000;
}

TEST(Interval, HoldsWhatMpfiHolds) {
  for (const Row& row : rows()) {
    const Judgement j = judge(row, box_count(), 1);
    EXPECT_EQ(j.missed, 0U) << row.name;
    EXPECT_LE(j.excess, row.ulps) << row.name << ": wider than stated";
  }
}

// The twin: enclosures that are wrong in the last bit, or inside.
TEST(IntervalTwin, WrongEnclosuresAreFound) {
  const auto wrong = [](const char* name, const Binary& ours) {
    for (Row row : rows()) {
      if (row.name != name) continue;
      row.ours = ours;
      return judge(row, 20000, 1).missed;
    }
    return std::size_t(0);
  };
  using I = RealInterval;
  EXPECT_GT(wrong("add", [](I a, I b) { return I(a.lo + b.lo, a.hi + b.hi); }), 1000U) << "rounding was lost";
  EXPECT_GT(wrong("sqrt", one([](I a) { return I(std::sqrt(a.lo), std::sqrt(a.hi)); })), 1000U);
  EXPECT_GT(
      wrong("multiply", [](I a, I b) { return I(detail::below(a.lo * b.lo), detail::above(a.hi * b.hi)); }),
      1000U)
      << "signs were forgotten";
  EXPECT_GT(wrong("cos", one([](I a) {
                    const double p = std::cos(a.lo), q = std::cos(a.hi);
                    return I(detail::well_below(std::min(p, q)), detail::well_above(std::max(p, q)));
                  })),
            1000U)
      << "extremes inside were forgotten";
  EXPECT_GT(wrong("exp", one([](I a) { return I(std::exp(a.lo), std::exp(a.hi)); })), 1000U);
}

// Narrower operands give narrower results.
TEST(Interval, IsMonotone) {
  for (const Row& row : rows()) {
    Pcg32 u(7);
    for (int i = 0; i < 4000; ++i) {
      const RealInterval a = random_box(row.lo, row.hi, u),
                         b = row.two ? random_box(row.lo2, row.hi2, u) : RealInterval();
      const auto part = [&u](RealInterval whole) {
        const double p = between(0, 1, u), q = between(0, 1, u);
        const double s = whole.lo + std::min(p, q) * (whole.hi - whole.lo),
                     t = whole.lo + std::max(p, q) * (whole.hi - whole.lo);
        return RealInterval(std::clamp(s, whole.lo, whole.hi), std::clamp(t, whole.lo, whole.hi));
      };
      EXPECT_TRUE(row.ours(a, b).contains(row.ours(part(a), part(b)))) << row.name;
    }
  }
}

TEST(Interval, AtTheEdges) {
  constexpr double inf = detail::infinity, most = detail::largest_double;
  EXPECT_EQ(RealInterval(1) / RealInterval(-1, 1), RealInterval::whole());
  EXPECT_EQ(RealInterval(1) / RealInterval(0, 0), RealInterval::whole());
  EXPECT_EQ((RealInterval(1, 2) / RealInterval(0, 1)).lo, 0);
  EXPECT_EQ((RealInterval(1, 2) / RealInterval(0, 1)).hi, inf);
  EXPECT_LT((RealInterval(0) * RealInterval::whole()).magnitude(), 1e-300) << "no member is infinite";
  const RealInterval over = RealInterval(most) + RealInterval(most);
  EXPECT_EQ(over.lo, most) << "an overflow is a number beyond the largest double";
  EXPECT_EQ(over.hi, inf);
  EXPECT_GE((RealInterval(0, 1) * RealInterval(0, 1)).lo, 0) << "signs of products are exact";
  EXPECT_EQ(sqrt(RealInterval(-1, 4)).lo, 0);
  EXPECT_EQ(log(RealInterval(0, 1)).lo, -inf);
  EXPECT_EQ(log1p(RealInterval(-2, 1)).lo, -inf);
  EXPECT_EQ(exp(RealInterval(-inf, 0)).lo, 0);
  EXPECT_EQ(cos(RealInterval(3, 3.2)).lo, -1);
  EXPECT_EQ(sin(RealInterval(1e9, 1e9)), RealInterval(-1, 1));
  EXPECT_EQ(tan(RealInterval(1, 2)), RealInterval::whole());
  EXPECT_TRUE(
      atan2(RealInterval(-1, 1), RealInterval(-1, 1)).contains(RealInterval(-3.14159265, 3.14159265)));
  EXPECT_LT(RealInterval(0.1L).lo, RealInterval(0.1L).hi) << "a long double that is no double";
  EXPECT_EQ(RealInterval(0.5L).lo, RealInterval(0.5L).hi);
  EXPECT_EQ(by_sign(RealInterval(-1, 1), RealInterval(2), RealInterval(5)), RealInterval(2, 5));
}

}  // namespace
}  // namespace reflectree
