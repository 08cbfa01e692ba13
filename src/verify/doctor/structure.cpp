// SPDX-License-Identifier: Apache-2.0
#include "structure.hpp"

#include <algorithm>
#include <numeric>

#include "findings.hpp"
#include "reflectree/math/frame.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree::detail {
namespace {

struct Repeats {
  double most = 0, any = 0;  // shares: of the commonest direction; of those seen before
  Direction commonest{};
};
Repeats repeats(Directions wi) {
  std::sort(wi.begin(), wi.end(), [](Direction a, Direction b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  });
  Repeats r;
  for (std::size_t i = 0; i < wi.size();) {
    std::size_t j = i + 1;
    while (j < wi.size() && wi[j] == wi[i]) ++j;
    if (double(j - i) > r.most) r.most = double(j - i), r.commonest = wi[i];
    r.any += double(j - i - 1);
    i = j;
  }
  r.most /= double(wi.size()), r.any /= double(wi.size());
  return r;
}

// The commonest elevation: a clamp heaps directions up at one.
Repeats commonest_cosine(const Directions& wi) {
  std::vector<float> z;
  for (const Direction w : wi) z.push_back(w.z);
  std::sort(z.begin(), z.end());
  Repeats r;
  for (std::size_t i = 0; i < z.size();) {
    std::size_t j = i + 1;
    while (j < z.size() && z[j] <= z[i] * (1 + 1e-6f)) ++j;
    if (double(j - i) > r.most) r.most = double(j - i), r.commonest.z = z[i];
    i = j;
  }
  r.most /= double(z.size());
  return r;
}

// Ranks of two coordinates on a grid: an area fills it, a curve touches a few per cent of its cells.
double occupancy(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr std::size_t across = 32;
  const std::size_t n = x.size();
  const auto ranks = [n](const std::vector<double>& v) {
    std::vector<std::size_t> order(n), rank(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return v[a] < v[b]; });
    for (std::size_t i = 0; i < n; ++i) rank[order[i]] = i * across / n;
    return rank;
  };
  const auto rx = ranks(x), ry = ranks(y);
  std::vector<int> cells(across * across);
  for (std::size_t i = 0; i < n; ++i) ++cells[rx[i] * across + ry[i]];
  // A cell counts where it holds a tenth of its share.
  const double least = 0.1 * double(n) / double(cells.size());
  return double(std::count_if(cells.begin(), cells.end(), [&](int c) { return c > least; })) /
         double(cells.size());
}

// A thin lobe may look like a line in one chart; a line is one in every chart.
double widest_occupancy(const ExaminedView& view) {
  const Vec3<double> wo = normalize(Vec3<double>{view.wo.x, view.wo.y, view.wo.z});
  double widest = 0;
  for (int chart = 0; chart < 3; ++chart) {
    const Vec3<double> pole = chart == 1 ? Vec3<double>{-wo.x, -wo.y, wo.z} : Vec3<double>{0, 0, 1};
    const LocalFrame<double> frame = frame_from_normal(pole);
    std::vector<double> x, y;
    for (const Direction d : view.wi) {
      const Vec3<double> wi{d.x, d.y, d.z};
      const Vec3<double> w = to_local(frame, chart == 2 ? normalize(wo + wi) : wi);
      x.push_back(std::atan2(w.y, w.x));
      y.push_back(sqr(w.x) + sqr(w.y));
    }
    widest = std::max(widest, occupancy(x, y));
  }
  return widest;
}

// sin^2 of the half vector or of the angle to the mirror direction in units of 2^-23, which is what
// 1 - c^2 steps by where c is a float near 1: mean resultant length of their phases. 1 for rounded cosines.
struct FloatSteps {
  double length = 0;
  Direction one{};  // of those directions
};
FloatSteps float_steps(const ExaminedView& view) {
  const Vec3<double> wo = normalize(Vec3<double>{view.wo.x, view.wo.y, view.wo.z});
  const Vec3<double> mirror{-wo.x, -wo.y, wo.z};
  FloatSteps longest;
  for (const bool half : {true, false}) {
    double c = 0, s = 0, n = 0;
    Direction one{};
    for (const Direction d : view.wi) {
      const Vec3<double> wi = normalize(Vec3<double>{d.x, d.y, d.z});
      const Vec3<double> v = half ? normalize(wo + wi) : cross(wi, mirror);
      const double steps = (half ? sqr(v.x) + sqr(v.y) : dot(v, v)) * 0x1p23;
      if (!(steps > 0.3 && steps < 40)) continue;
      const double phase = 2 * pi_v<double> * steps;
      one = d;
      c += std::cos(phase), s += std::sin(phase), ++n;
    }
    if (n >= 1000 && std::hypot(c, s) / n > longest.length) longest = {std::hypot(c, s) / n, one};
  }
  return longest;
}

// Successive draws sorted into eight classes of nearly equal probability: 49 degrees of freedom.
double dependence_p(const ExaminedView& view, int lag) {
  constexpr int classes = 8;
  std::vector<double> below(view.count.size() + 1);
  for (std::size_t b = 0; b < view.count.size(); ++b) below[b + 1] = below[b] + view.count[b];
  const double total = below.back();
  const auto class_of = [&](int place) {
    const std::size_t b = view.bin[std::size_t(place)];
    return std::min(int((below[b] + 0.5 * view.count[b]) / total * classes), classes - 1);
  };
  std::vector<double> table(classes * classes), row(classes), column(classes);
  double pairs = 0;
  for (std::size_t i = 0; i + std::size_t(lag) < view.order.size(); ++i) {
    if (view.order[i] < 0 || view.order[i + std::size_t(lag)] < 0) continue;
    const int a = class_of(view.order[i]), b = class_of(view.order[i + std::size_t(lag)]);
    ++table[std::size_t(a * classes + b)], ++row[std::size_t(a)], ++column[std::size_t(b)], ++pairs;
  }
  if (pairs < 2000) return 1;
  double statistic = 0;
  int rows = 0, columns = 0;
  for (int a = 0; a < classes; ++a) {
    rows += row[std::size_t(a)] > 0, columns += column[std::size_t(a)] > 0;
    for (int b = 0; b < classes; ++b) {
      const double expected = row[std::size_t(a)] * column[std::size_t(b)] / pairs;
      if (expected > 0) statistic += sqr(table[std::size_t(a * classes + b)] - expected) / expected;
    }
  }
  if (rows < 2 || columns < 2) return 1;
  return chi_square_tail(statistic, double((rows - 1) * (columns - 1)));
}

}  // namespace

bool check_structure(const Functions&, std::span<const ExaminedView> views, double level, Diagnosis& d) {
  double most = 0, any = 0, piled = 0, least_occupied = 1, steps = 0, least_p = 1;
  const ExaminedView *most_at = nullptr, *any_at = nullptr, *piled_at = nullptr, *curve_at = nullptr,
                     *steps_at = nullptr, *dependent_at = nullptr;
  Direction commonest{}, on_ring{};
  float clamp = 0;
  int lag_at = 1;
  for (const ExaminedView& view : views) {
    if (view.wi.size() < 2000) continue;
    const Repeats r = repeats(view.wi), z = commonest_cosine(view.wi);
    if (r.most > most) most = r.most, most_at = &view, commonest = r.commonest;
    if (r.any > any) any = r.any, any_at = &view;
    // Next to the normal many cosines round to the same float.
    if (z.most > piled && z.commonest.z < 0.9f) piled = z.most, piled_at = &view, clamp = z.commonest.z;
    const double occupied = view.wi.size() >= 20'000 ? widest_occupancy(view) : 1;
    if (occupied < least_occupied) least_occupied = occupied, curve_at = &view;
    const FloatSteps s = float_steps(view);
    if (s.length > steps) steps = s.length, steps_at = &view, on_ring = s.one;
    for (int lag = 1; lag <= 3; ++lag) {
      const double p = dependence_p(view, lag);
      if (p < least_p) least_p = p, dependent_at = &view, lag_at = lag;
    }
  }
  d.checks.push_back(limited("spread", most, 1e-3, "share of the commonest direction"));
  d.checks.push_back(limited("spread", any, 0.02, "share of directions seen before"));
  d.checks.push_back(limited("spread", piled, 5e-3, "share of the commonest cosine"));
  d.checks.push_back(limited("spread", 1 - least_occupied, 0.88, "share of an empty plane"));
  d.checks.push_back(limited("spread", steps, 0.5, "steps of single precision near the pole of a lobe"));
  CheckResult independent =
      limited("independent", 1 - least_p, 1 - level, text("lag %.0f, 49 degrees of freedom", double(lag_at)),
              dependent_at ? dependent_at->where : "");
  independent.p_value = least_p;
  independent.passed = least_p >= level;
  d.checks.push_back(independent);

  const bool ignored = std::any_of(d.findings.begin(), d.findings.end(),
                                   [](const Finding& x) { return x.cause == "seed_ignored"; });
  if (ignored) return true;  // everything below follows
  const auto add = [&](const char* check, const char* cause, const std::string& words, const ExaminedView& at,
                       Direction wi) {
    d.findings.push_back(a_finding(check, cause, words, {at.wo, wi, {}, 0, 0}));
  };
  const bool rounded = steps > 0.5;
  const bool discrete = !rounded && most > 1e-3, pile = !rounded && !discrete && piled > 5e-3;
  const bool curve = !rounded && !discrete && 1 - least_occupied > 0.88;
  if (discrete) {
    add("spread", "discrete_lobe",
        text(
            "%.3g %% of the directions are one and the same: a discrete lobe among directions with a density",
            100 * most),
        *most_at, commonest);
  }
  if (pile && !curve) {
    add("spread", "grazing_clamped",
        text("%.3g %% of the directions lie at cos_theta_i = %.4g exactly: directions beyond are moved there",
             100 * piled, double(clamp)),
        *piled_at, {float(std::sqrt(1 - sqr(double(clamp)))), 0, clamp});
  }
  if (curve) {
    add("spread", "same_random_number", "the directions lie on a curve: the same random number is used twice",
        *curve_at, curve_at->wi[0]);
  }
  if (rounded) {
    add("spread", "float_precision",
        "cosines near 1 are rounded to single precision: the directions of a sharp lobe lie on rings",
        *steps_at, on_ring);
  }
  const bool repeated = !discrete && !curve && !rounded && any > 0.02;
  if (repeated) {
    add("spread", "repeated", text("%.3g %% of the directions have been drawn before", 100 * any), *any_at,
        any_at->wi[0]);
  }
  if (!independent.passed && !discrete && !curve) {
    add("independent", "correlated",
        text("directions depend on those drawn %.0f before: the random numbers are correlated",
             double(lag_at)),
        *dependent_at, dependent_at->wi[0]);
  }
  return discrete || pile || curve || rounded || repeated;
}

}  // namespace reflectree::detail
