// SPDX-License-Identifier: Apache-2.0
#include "density.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>

#include "explanations.hpp"
#include "findings.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree::detail {
namespace {

// The bin that tells most, with what was expected and found there.
Evidence worst_bin(const ExaminedView& view) {
  Evidence e{view.wo, {}, "share of the directions in the bin about wi", 0, 0};
  double worst = 0;
  const auto& boxes = view.bins.boxes;
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    const double expected = view.pdf_mass[b] * view.draws;
    const double off = sqr(view.count[b] - expected) / std::max(expected, 1.);
    if (!(off > worst)) continue;
    worst = off;
    const auto p =
        view.bins.chart.direction({0.5 * (boxes[b].x0 + boxes[b].x1), 0.5 * (boxes[b].y0 + boxes[b].y1)});
    e.wi = {float(p.w.x), float(p.w.y), float(p.w.z)};
    e.found = view.count[b] / view.draws, e.expected = view.pdf_mass[b];
  }
  return e;
}

// A pair of round directions at which pdf and truth differ well.
std::optional<Evidence> simple_pair(const Functions& f, const DensityVerdict& verdict) {
  if (!verdict.truth) return std::nullopt;
  Directions wo, wi;
  for (const double theta_o : {0., 30., 45., 60.}) {
    for (const double theta_i : {0., 30., 45., 60., 75.}) {
      for (const double phi : {180., 0., 90., 150.}) {
        wo.push_back(direction_from_angles(float(theta_o * pi_v<double> / 180), 0.f));
        wi.push_back(
            direction_from_angles(float(theta_i * pi_v<double> / 180), float(phi * pi_v<double> / 180)));
      }
    }
  }
  const std::vector<double> claimed = f.pdf(wo, wi), true_density = verdict.truth(wo, wi);
  for (const double least : {0.1, 1e-3}) {
    for (std::size_t i = 0; i < wo.size(); ++i) {
      const double larger = std::max(claimed[i], true_density[i]);
      if (std::isfinite(larger) && larger > least &&
          std::abs(claimed[i] - true_density[i]) > std::max(0.05 * larger, 0.)) {
        return Evidence{wo[i], wi[i], "pdf(wo, wi)", claimed[i], true_density[i]};
      }
    }
  }
  return std::nullopt;
}

}  // namespace

DensityVerdict judge_density(const Functions& f, std::span<const ExaminedView> views, double level,
                             bool degenerate, const Host& host, Diagnosis& d) {
  DensityVerdict verdict;
  if (!f.has_pdf()) return verdict;
  const double z = normal_two_sided_quantile(level);
  bool shape_holds = true, integral_holds = true;
  const ExaminedView* worst = nullptr;
  double worst_ratio = 0;
  for (const ExaminedView& view : views) {
    if (view.wi.empty() && !(view.pdf_integral > 0)) continue;
    verdict.judged = true;
    const double lost = view.lost / view.draws;
    char detail[120];
    std::snprintf(detail, sizeof detail, "integral of pdf %.5f, share of lost draws %.5f", view.pdf_integral,
                  lost);
    // Draws below the horizon that carry a weight are told of by themselves.
    const CheckResult integral =
        limited("pdf_integral", std::abs(unaccounted(view)), integral_tolerance(view, z), detail, view.where);
    const Fit fit = fit_of(view, view.pdf_mass, true);
    CheckResult shape = limited("chi_square_pdf", fit.statistic, 0, "", view.where);
    std::snprintf(detail, sizeof detail, "%.0f bins, level %.2g", fit.dof + 1, level);
    shape.threshold = chi_square_quantile(level, std::max(fit.dof, 1.));
    shape.p_value = fit.p_value, shape.detail = detail;
    shape.passed = fit.p_value >= level;
    shape_holds = shape_holds && shape.passed;
    integral_holds = integral_holds && integral.passed;
    const double ratio = std::max(integral.statistic / integral.threshold, fit.statistic / shape.threshold);
    if (ratio > worst_ratio) worst_ratio = ratio, worst = &view;
    d.checks.push_back(integral);
    d.checks.push_back(shape);
  }
  if (!verdict.judged) return verdict;
  verdict.holds = shape_holds && integral_holds;
  if (verdict.holds) {
    verdict.truth = [f](std::span<const Direction> wo, std::span<const Direction> wi) {
      return f.pdf(wo, wi);
    };
    return verdict;
  }
  if (degenerate) return verdict;
  host.stage("hypotheses");
  Explanation e = explain_density(f, views, shape_holds, level, host);
  Finding finding;
  finding.check = shape_holds ? "pdf_integral" : "chi_square_pdf";
  finding.figures = {{"integral_of_pdf", worst->where, worst->pdf_integral},
                     {"share_of_lost_draws", worst->where, worst->lost / worst->draws}};
  verdict.explained = !e.cause.empty();
  verdict.truth = e.truth;
  finding.cause = verdict.explained ? e.cause : "unexplained";
  finding.words = verdict.explained ? e.words
                  : shape_holds     ? "pdf and lost draws do not add up to 1"
                                    : "directions do not follow pdf, and no hypothesis explains how";
  const auto pair = simple_pair(f, verdict);
  // Where only the total is wrong, no bin says more than another.
  if (pair || !shape_holds) finding.evidence = pair ? *pair : worst_bin(*worst);
  d.findings.push_back(std::move(finding));
  return verdict;
}

}  // namespace reflectree::detail
