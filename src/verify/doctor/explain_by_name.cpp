// SPDX-License-Identifier: Apache-2.0
// Transformations with a name. Of directions: undone on what was drawn, whose bins are then pdf's.
#include <algorithm>

#include "density_search.hpp"
#include "hypotheses.hpp"
#include "reflectree/verify/bin_masses.hpp"

namespace reflectree::detail {
namespace {

Masses masses_of(const DensitySearch& s, const DensityHypothesis& h, const ExaminedView& v) {
  TargetFunction density;
  density.concurrent = s.f.patient().concurrent;
  density.eval = [&](Vec3<double> wo, std::span<const Vec3<double>> wi, std::span<double> out) {
    Directions a, b;
    for (const auto& w : wi) {
      const DirectionPair p = h.turn ? h.turn({wo, w}) : DirectionPair{wo, w};
      a.push_back(narrow(p.wo)), b.push_back(narrow(p.wi));
    }
    const std::vector<double> pdf = s.f.pdf(a, b);
    for (std::size_t i = 0; i < wi.size(); ++i) {
      const double factor = h.factor ? h.factor({wo, wi[i]}) : 1;
      out[i] = wi[i].z > 0 ? sane_or_zero(pdf[i] * factor) / wi[i].z : 0;
    }
  };
  return function_masses(density, v.bins, 1e-3, s.host).mass;
}

std::optional<double> judge(const DensitySearch& s, const DensityHypothesis& h) {
  double total = 0;
  for (const ExaminedView& v : s.views) {
    if (v.wi.empty()) continue;
    Fit fit;
    double integral = v.pdf_integral;
    const Vec3<double> wo = widen(v.wo);
    const bool turns_wi = h.turn && h.turn({wo, {0, 0, 1}}).wo == wo;
    if (turns_wi) {
      fit = fit_of(recounted(v, h.turn), v.pdf_mass, true);
    } else {
      Masses m;
      if (!h.turn) {
        m = reweighted(v, v.pdf_mass, v.pdf_at, [&](std::size_t i) {
          return v.pdf_at[i] * h.factor({wo, widen(v.nodes.wi[i])});
        });
        fit = fit_of(v, m, true);
        if (fit.statistic > 30 * fit.dof) return std::nullopt;
      }
      // The nodes are rough; what they do not rule out is integrated well.
      if (h.turn || !s.fits(fit) || !s.total_fits(v, total_of(m))) m = masses_of(s, h, v);
      fit = fit_of(v, m, true);
      integral = total_of(m);
    }
    if (!s.fits(fit) || !s.total_fits(v, integral)) return std::nullopt;
    total += fit.statistic;
  }
  return total;
}

// Which of the two is off, by which of them is more like f.
std::string blame(const DensitySearch& s) {
  double of_pdf = 0, of_draws = 0;
  for (const ExaminedView& v : s.views) {
    for (std::size_t b = 0; b < v.count.size(); ++b) {
      const double like_f = v.albedo > 0 ? v.f_mass[b] / v.albedo : 0;
      of_pdf += std::min(like_f, v.pdf_mass[b]);
      of_draws += std::min(like_f, v.count[b] / v.draws);
    }
  }
  if (std::abs(of_pdf - of_draws) < 0.02 * double(s.views.size())) return "";
  return of_pdf > of_draws ? "; f is like pdf, so the directions are off"
                           : "; f is like the directions, so pdf is off";
}

}  // namespace

Explanation explain_by_name(const DensitySearch& s, bool shape_holds) {
  double unexplained = 0;  // chi-square of pdf as it is
  for (const ExaminedView& v : s.views) unexplained += fit_of(v, v.pdf_mass, true).statistic;
  const DensityHypothesis* best = nullptr;
  double least = 0;
  for (const DensityHypothesis& h : density_hypotheses()) {
    if (shape_holds && h.turn) continue;
    const auto statistic = judge(s, h);
    // Clearly better than pdf itself, and a later one than those before.
    if (!statistic || (!shape_holds && *statistic > unexplained - 30)) continue;
    if (!best || *statistic < least - 30) best = &h, least = *statistic;
  }
  if (!best) return {};
  Explanation e{best->cause, best->words, {}};
  if (best->turn && std::string_view(best->cause).starts_with("pdf") == false) e.words += blame(s);
  e.truth = [f = s.f, h = *best](std::span<const Direction> wo, std::span<const Direction> wi) {
    Directions a(wo.begin(), wo.end()), b(wi.begin(), wi.end());
    for (std::size_t i = 0; h.turn && i < a.size(); ++i) {
      const DirectionPair p = h.turn({widen(wo[i]), widen(wi[i])});
      a[i] = narrow(p.wo), b[i] = narrow(p.wi);
    }
    std::vector<double> pdf = f.pdf(a, b);
    for (std::size_t i = 0; h.factor && i < a.size(); ++i) pdf[i] *= h.factor({widen(wo[i]), widen(wi[i])});
    return pdf;
  };
  return e;
}

}  // namespace reflectree::detail
