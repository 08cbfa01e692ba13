// SPDX-License-Identifier: Apache-2.0
#include "light.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "findings.hpp"

namespace reflectree::detail {
namespace {

constexpr std::size_t groups = 16;

// How far the mean of n variables in [0, range] may be from its expectation, but for one case in 2 e^l:
// Bernstein's inequality. Weights of a poor sampler are rare and large, so that their sums are far from normal.
double bernstein(double variance, double range, double n, double l) {
  const double b = range * l / 3;
  return (b + std::sqrt(b * b + 2 * n * variance * l)) / n;
}

}  // namespace

bool check_light(const Functions& f, std::span<const ExaminedView> views, double level, Diagnosis& d) {
  bool holds = true;
  const double l = std::log(2 * double(groups + 1) / level);
  for (const ExaminedView& v : views) {
    if (!(v.draws > 0) || !(v.albedo > 0)) continue;
    const std::size_t bins = v.count.size();
    // The last group is everything. Bins that follow each other are neighbours.
    std::array<double, groups + 1> got{}, expected{}, measured2{}, known2{}, range{};
    const auto add = [&](std::array<double, groups + 1>& to, std::size_t bin, double x) {
      to[bin * groups / bins] += x, to[groups] += x;
    };
    for (std::size_t b = 0; b < bins; ++b) {
      add(got, b, v.light[b] / v.draws), add(expected, b, v.f_mass[b]),
          add(measured2, b, v.light2[b] / v.draws);
    }
    const auto reach = [&](std::size_t bin, double x) {
      for (const std::size_t g : {bin * groups / bins, groups}) range[g] = std::max(range[g], x);
    };
    for (std::size_t i = 0; f.has_pdf() && i < v.nodes.wi.size(); ++i) {
      if (!(v.pdf_at[i] > 0)) continue;
      const double w = v.f_cos_at[i] / v.pdf_at[i];
      add(known2, v.nodes.bin[i], v.nodes.solid_angle[i] * w * v.f_cos_at[i]);
      reach(v.nodes.bin[i], w);
    }
    for (std::size_t i = 0; i < v.wi.size(); ++i) reach(v.bin[i], v.weight[i]);
    double worst = 0;
    for (std::size_t g = 0; g <= groups; ++g) {
      const double second = std::max(measured2[g], known2[g]);
      const double allowed = bernstein(std::max(second - sqr(expected[g]), 0.), 1.5 * range[g], v.draws, l) +
                             1.5e-3 * expected[g] + (g < groups ? 3e-4 : 5e-4) * v.albedo;
      worst = std::max(worst, std::abs(got[g] - expected[g]) / allowed);
    }
    char detail[120];
    std::snprintf(detail, sizeof detail,
                  "mean weight %.6g, albedo %.6g; worst of 16 regions and all, over what chance allows",
                  got[groups], expected[groups]);
    d.checks.push_back(limited("light", worst, 1, detail, v.where));
    holds = holds && worst <= 1;
  }
  return holds;
}

void check_support(const Functions& f, std::span<const ExaminedView> views, Diagnosis& d) {
  if (!f.has_pdf()) return;
  const ExaminedView* at = nullptr;
  double most = 0;
  for (const ExaminedView& v : views) {
    double lost = 0;
    for (std::size_t i = 0; i < v.nodes.wi.size(); ++i) {
      if (!(v.pdf_at[i] > 0)) lost += v.nodes.solid_angle[i] * v.f_cos_at[i];
    }
    if (!(v.albedo > 0)) continue;
    d.checks.push_back(
        limited("support", lost / v.albedo, 1e-3, "share of the light where pdf is 0", v.where));
    if (lost / v.albedo > most) most = lost / v.albedo, at = &v;
  }
  if (most <= 1e-3) return;
  std::size_t brightest = 0;
  double value = -1;
  for (std::size_t i = 0; i < at->nodes.wi.size(); ++i) {
    if (!(at->pdf_at[i] > 0) && at->f_cos_at[i] > value) value = at->f_cos_at[i], brightest = i;
  }
  char words[160];
  std::snprintf(words, sizeof words, "pdf is 0 where f is not: %.3g %% of the light are never sampled",
                100 * most);
  d.findings.push_back(a_finding(
      "support", "no_support", words,
      {at->wo, at->nodes.wi[brightest], "pdf(wo, wi) where f cos_theta_i is as expected", 0, value}));
  d.findings.back().figures.push_back({"share_of_light", at->where, most});
}

void measure_quality(const Functions&, std::span<const ExaminedView> views, Diagnosis& d) {
  double seconds = 0, draws = 0;
  for (const ExaminedView& v : views) {
    const double sum = std::accumulate(v.light.begin(), v.light.end(), 0.),
                 sum2 = std::accumulate(v.light2.begin(), v.light2.end(), 0.);
    const double worst = v.weight.empty() ? 0 : *std::max_element(v.weight.begin(), v.weight.end());
    if (sum > 0) {
      d.figures.push_back({"relative_variance", v.where, v.draws * sum2 / (sum * sum) - 1});
      d.figures.push_back({"worst_weight_over_mean", v.where, worst * v.draws / sum});
    }
    d.figures.push_back({"lost_share", v.where, v.lost / v.draws});
    d.figures.push_back({"albedo", v.where, v.albedo});
    seconds += v.seconds, draws += v.draws;
  }
  if (draws > 0) d.figures.push_back({"nanoseconds_per_draw", "", 1e9 * seconds / draws});
}

}  // namespace reflectree::detail
