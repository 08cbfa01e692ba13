// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/consistency.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "neighbours.hpp"
#include "parallel.hpp"
#include "reflectree/verify/bins.hpp"

namespace reflectree {
namespace {

using detail::neighbours;
using detail::Range;

struct Counts {
  int drawn = 0, none = 0, dead = 0, invalid = 0, not_finite = 0;
  int pdf_differs = 0, weight_differs = 0;
};

Counts draw_and_compare(const ErasedSampler& sampler, const TargetFunction& f, Direction wo,
                        const ConsistencyOptions& options) {
  const Vec3<double> w = normalize(Vec3<double>{wo.x, wo.y, wo.z});
  Counts counts;
  Pcg32 u = detail::part_generator(options.seed, 0);
  for (int i = 0; i < options.samples; ++i) {
    DrawnDirection d;
    if (!sampler.sample(wo, u, d)) {
      ++counts.none;
      continue;
    }
    ++counts.drawn;
    if (!is_finite(d.wi) || !std::isfinite(d.pdf) || !std::isfinite(d.weight)) {
      ++counts.not_finite;
      continue;
    }
    counts.invalid += !(d.wi.z > 0) || (sampler.pdf && !(d.pdf > 0));
    counts.dead += !(d.weight > 0);
    const auto around = neighbours(d.wi);
    std::array<double, around.size()> t;
    f.eval(w, around, t);
    Range f_cos, pdf;
    for (std::size_t k = 0; k < around.size(); ++k) {
      f_cos.add(t[k] * around[k].z);
      if (sampler.pdf) {
        pdf.add(double(sampler.pdf(wo, {float(around[k].x), float(around[k].y), float(around[k].z)})));
      }
    }
    const bool known = sampler.pdf || d.pdf > 0;
    counts.weight_differs += known && !f_cos.holds(double(d.weight) * double(d.pdf), options.tolerance);
    if (sampler.pdf) counts.pdf_differs += !pdf.holds(double(d.pdf), options.tolerance);
  }
  return counts;
}

CheckResult share(const char* name, int count, int of, double limit, const char* what) {
  CheckResult result;
  result.name = name;
  result.statistic = of > 0 ? double(count) / of : 0;
  result.threshold = limit;
  result.passed = of > 0 && result.statistic <= limit;
  char buffer[128];
  std::snprintf(buffer, sizeof buffer, "%d of %d %s", count, of, what);
  result.detail = buffer;
  return result;
}

// Below, 1 - x^2 - y^2 is rounding error: a map by way of the disk cannot know the direction.
constexpr double horizon = 5e-4;

// Points spread over the bins, and so over the lobe, independently of the sampler.
CheckResult check_support(const ErasedSampler& sampler, const TargetFunction& f, const Bins& bins) {
  const Vec3<double> w = normalize(Vec3<double>{bins.wo.x, bins.wo.y, bins.wo.z});
  Pcg32 u = detail::part_generator(2, 0);
  std::vector<Vec3<double>> wi;
  for (const CubatureBox& r : bins.boxes) {
    for (int k = 0; k < 16; ++k) {
      const Direction d = [&] {
        const auto p = bins.chart.direction(
            {linear_mix(to_unit_double(u()), r.x0, r.x1), linear_mix(to_unit_double(u()), r.y0, r.y1)});
        return Direction{float(p.w.x), float(p.w.y), float(p.w.z)};
      }();
      wi.push_back({d.x, d.y, d.z});
    }
  }
  std::vector<double> t(wi.size());
  f.eval(w, wi, t);
  int lit = 0, lost = 0;
  for (std::size_t i = 0; i < wi.size(); ++i) {
    if (!(t[i] * wi[i].z > 0) || wi[i].z < horizon) continue;
    ++lit;
    lost += !(sampler.pdf(bins.wo, {float(wi[i].x), float(wi[i].y), float(wi[i].z)}) > 0);
  }
  return share("support", lost, lit, 0, "points with t > 0 have pdf 0");
}

CheckResult check_pdf_integral(std::span<const double> density, double none_share,
                               const ConsistencyOptions& options) {
  double integral = 0;
  for (const double m : density) integral += m;
  CheckResult result;
  result.name = "pdf_integral";
  result.statistic = std::abs(integral + none_share - 1);
  // The share of "no sample" is itself a count.
  result.threshold = options.integral_tolerance + 4 * std::sqrt(none_share / options.samples);
  result.passed = result.statistic <= result.threshold;
  char buffer[128];
  std::snprintf(buffer, sizeof buffer, "integral of pdf %.6f, share of \"no sample\" %.6f", integral,
                none_share);
  result.detail = buffer;
  return result;
}

}  // namespace

std::vector<CheckResult> check_consistency(const ErasedSampler& sampler, const TargetFunction& f,
                                           const Bins& bins, std::span<const double> density,
                                           const ConsistencyOptions& options) {
  const Counts c = draw_and_compare(sampler, f, bins.wo, options);
  std::vector<CheckResult> results;
  const int all = options.samples;
  results.push_back(share("weight_agrees", c.weight_differs, c.drawn, options.max_exceptions,
                          "samples: weight * pdf is not t cos_i"));
  results.push_back(share("alive", c.none + c.dead + (c.invalid > 0 ? all : 0), all, options.max_none,
                          "draws gave no sample, weight 0, or a direction without density"));
  results.push_back(share("finite", c.not_finite, all, 0, "draws are not finite"));
  if (sampler.pdf) {
    results.push_back(share("pdf_agrees", c.pdf_differs, c.drawn, options.max_exceptions,
                            "samples: pdf is not pdf(wo, wi)"));
    results.push_back(check_support(sampler, f, bins));
    results.push_back(check_pdf_integral(density, double(c.none) / all, options));
  }
  return results;
}

std::vector<CheckResult> check_consistency(const ErasedSampler& sampler, const TargetFunction& f,
                                           Direction wo, const ConsistencyOptions& options,
                                           const Host& host) {
  const Bins bins = equal_mass_bins(f, wo, {}, host);
  std::vector<double> density;
  if (sampler.pdf) density = density_masses(sampler, bins, options.integral_tolerance / 2, host);
  return check_consistency(sampler, f, bins, density, options);
}

}  // namespace reflectree
