// SPDX-License-Identifier: Apache-2.0
// Parts of pdf that are never drawn, or not enough.
#include <algorithm>

#include "density_search.hpp"
#include "findings.hpp"

namespace reflectree::detail {
namespace {

// The masses with straddling bins set to what was counted, so that they decide nothing.
Masses merged_at(const ExaminedView& v, Masses m, double z) {
  std::vector<double> lo(m.size(), 2), hi(m.size(), -1);
  for (std::size_t i = 0; i < v.nodes.wi.size(); ++i) {
    const std::size_t b = v.nodes.bin[i];
    lo[b] = std::min(lo[b], double(v.nodes.wi[i].z)), hi[b] = std::max(hi[b], double(v.nodes.wi[i].z));
  }
  for (std::size_t b = 0; b < m.size(); ++b) {
    const double slack = 0.1 * (hi[b] - lo[b]) + 1e-6;
    if (lo[b] - slack < z && z < hi[b] + slack) m[b] = v.count[b] / v.draws;
  }
  return m;
}

}  // namespace

Explanation explain_cut(const DensitySearch& s) {
  double lowest = 1;
  for (const ExaminedView& v : s.views) {
    for (const Direction w : v.wi) lowest = std::min(lowest, double(w.z));
  }
  double most = 0;
  const auto above = [&](const ExaminedView& v) {
    Masses m = reweighted(v, v.pdf_mass, v.pdf_at,
                          [&](std::size_t i) { return double(v.nodes.wi[i].z) >= lowest ? v.pdf_at[i] : 0; });
    most = std::max(most, v.pdf_integral - total_of(m));
    return normalised_to(std::move(m), drawn_share(v));
  };
  // Bins that straddle the border are known to a node's width only.
  double worst = 0;
  for (const ExaminedView& v : s.views) {
    if (v.wi.empty()) continue;
    const Fit fit = fit_of(v, merged_at(v, above(v), lowest), true);
    worst = std::max(worst, fit.p_value >= s.level ? 0. : 1.);
  }
  if (worst > 0 || !(most > 3e-4)) return {};
  return {"grazing_never",
          text("directions with cos_theta_i below %.3g are never drawn, where pdf has up to %.2g %%", lowest,
               100 * most),
          nullptr};
}

Explanation explain_half_lobe(const DensitySearch& s) {
  constexpr const char* sides[] = {"x > 0", "x < 0", "y > 0", "y < 0"};
  for (int side = 0; side < 4; ++side) {
    const auto on = [&](Vec3<double> wo, Direction d) {
      const Vec3<double> h = wo + widen(d);
      return side == 0 ? h.x > 0 : side == 1 ? h.x < 0 : side == 2 ? h.y > 0 : h.y < 0;
    };
    double off = 0, expected_off = 0, all = 0;
    for (const ExaminedView& v : s.views) {
      const Vec3<double> wo = widen(v.wo);
      for (const Direction w : v.wi) off += !on(wo, w), ++all;
      for (std::size_t i = 0; i < v.pdf_at.size(); ++i) {
        if (!on(wo, v.nodes.wi[i])) expected_off += v.pdf_at[i] * v.nodes.solid_angle[i] * v.draws;
      }
    }
    if (off > 0.002 * all || expected_off < 0.1 * all) continue;
    return {"half_lobe",
            std::string("only half vectors with ") + sides[side] +
                " are drawn: half of the lobe is lost, as where atan forgets the quadrant of phi",
            nullptr};
  }
  return {};
}

Explanation explain_low_bound(const DensitySearch& s) {
  for (const bool cosine : {false, true}) {
    double most_lost = 0;
    bool all = true, any = false;
    for (const ExaminedView& v : s.views) {
      if (v.wi.empty()) continue;
      const auto q = [&](std::size_t i) { return cosine ? double(v.nodes.wi[i].z) : 1.; };
      double highest = 0;
      for (std::size_t i = 0; i < v.pdf_at.size(); ++i)
        highest = std::max(highest, v.pdf_at[i] / std::max(q(i), 1e-6));
      const auto masses = [&](double bound) {
        return normalised_to(reweighted(v, v.pdf_mass, v.pdf_at,
                                        [&](std::size_t i) { return std::min(v.pdf_at[i], bound * q(i)); }),
                             drawn_share(v));
      };
      double best = highest, least = fit_of(v, v.pdf_mass, true).statistic;
      for (double bound = highest, step = 1.25; step > 1.002; step = std::sqrt(step)) {
        for (int k = -12; k <= 12; ++k) {
          const double here = bound * std::pow(step, k);
          const double found = fit_of(v, masses(here), true).statistic;
          if (found < least) least = found, best = here;
        }
        bound = best;
      }
      if (!s.fits(fit_of(v, masses(best), true))) {
        all = false;
        break;
      }
      if (best < 0.95 * highest) any = true;
      double cut = 0;
      for (std::size_t i = 0; i < v.pdf_at.size(); ++i)
        cut += v.nodes.solid_angle[i] * std::max(v.pdf_at[i] - best * q(i), 0.);
      most_lost = std::max(most_lost, cut);
    }
    if (!all || !any) continue;
    return {"bound_too_low",
            text("the density is cut off where pdf is highest: a bound of rejection is too low, up to %.2g "
                 "%% of pdf lie above it",
                 100 * most_lost),
            nullptr};
  }
  return {};
}

}  // namespace reflectree::detail
