// SPDX-License-Identifier: Apache-2.0
// What the explanations of a density share (explanations.hpp): a hypothesis says what the masses per bin are, and
// must fit at every viewer.
#pragma once

#include <algorithm>
#include <optional>

#include "explanations.hpp"

namespace reflectree::detail {

using Masses = std::vector<double>;

double total_of(const Masses& m);
inline double drawn_share(const ExaminedView& v) { return double(v.wi.size()) / v.draws; }
Masses normalised_to(Masses m, double total);
// Of a cosine lobe, or of uniform directions.
Masses lobe_masses(const ExaminedView& v, bool cosine, const Host& host);

// The masses of pdf, reweighted by the sums over the nodes of a bin: errors of the nodes cancel.
template <class At>
Masses reweighted(const ExaminedView& v, const Masses& of, const std::vector<double>& at, const At& changed) {
  Masses before(of.size()), after(of.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double here = v.nodes.solid_angle[i] * at[i];
    before[v.nodes.bin[i]] += here;
    after[v.nodes.bin[i]] += v.nodes.solid_angle[i] * changed(i);
  }
  for (std::size_t b = 0; b < of.size(); ++b) {
    const double ratio = before[b] > 0 ? of[b] / before[b] : 1;
    if (ratio > 0.8 && ratio < 1.25) after[b] *= ratio;  // beyond, the masses themselves are in doubt
  }
  return after;
}

// The view with its directions turned.
template <class Turn>
ExaminedView recounted(const ExaminedView& v, const Turn& turn) {
  ExaminedView r = v;
  std::fill(r.count.begin(), r.count.end(), 0.);
  const Vec3<double> wo = widen(v.wo);
  for (const Direction w : v.wi) ++r.count[v.bins.find(narrow(turn({wo, widen(w)}).wi))];
  return r;
}

struct DensitySearch {
  const Functions& f;
  std::span<const ExaminedView> views;
  double level;
  const Host& host;

  bool fits(const Fit& fit) const { return fit.p_value >= level; }
  bool total_fits(const ExaminedView& v, double total) const;
  // Every view, or nothing. masses(view) as the hypothesis has them; the total counts where `absolute`.
  template <class Of>
  std::optional<double> statistic(const Of& masses, bool absolute) const {
    double total = 0;
    for (const ExaminedView& v : views) {
      if (v.wi.empty()) continue;
      const Masses m = masses(v);
      const Fit fit = fit_of(v, m, true);
      if (!fits(fit) || (absolute && !total_fits(v, total_of(m)))) return std::nullopt;
      total += fit.statistic;
    }
    return total;
  }
};

// Each an explanation, or none.
Explanation explain_by_name(const DensitySearch& s, bool shape_holds);
// The shape is right and the total is not, by a factor that is always the same, or not.
Explanation explain_total(const DensitySearch& s);
// Densities of their own: that of f, with and without cosine, a cosine lobe, uniform.
Explanation explain_other_density(const DensitySearch& s);
// Directions next to the horizon are never drawn.
Explanation explain_cut(const DensitySearch& s);
// One half of the half vectors is missing, as where atan loses the quadrant.
Explanation explain_half_lobe(const DensitySearch& s);
// pdf is a lobe s and a cosine lobe c, p = w c + (1 - w) s; drawn with another weight it is a p + b c.
Explanation explain_mixture(const DensitySearch& s);
// Rejection from a cosine lobe, or uniform, under a bound that is too low: min(p, bound * q).
Explanation explain_low_bound(const DensitySearch& s);
// pdf turned about the normal by any angle.
Explanation explain_turned(const DensitySearch& s);
// pdf shifted along an elevation.
Explanation explain_shifted(const DensitySearch& s);

}  // namespace reflectree::detail
