// SPDX-License-Identifier: Apache-2.0
#include "below.hpp"

#include <algorithm>

#include "findings.hpp"

namespace reflectree::detail {

double pdf_below(const Functions& f, Direction wo) {
  constexpr int nz = 200, nphi = 300;
  Directions wi;
  for (int i = 0; i < nz; ++i) {
    const double z = -(i + 0.5) / nz, r = std::sqrt(1 - z * z);
    for (int k = 0; k < nphi; ++k) {
      const double phi = 2 * pi_v<double> * (k + 0.5) / nphi;
      wi.push_back({float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)});
    }
  }
  double total = 0;
  for (const double p : f.pdf(Directions(wi.size(), wo), wi)) total += sane_or_zero(p);
  return total * 2 * pi_v<double> / double(wi.size());
}

void remark_on_pdf_below(const Functions& f, std::span<const ExaminedView> views, Diagnosis& d) {
  if (!f.has_pdf()) return;
  const ExaminedView* at = nullptr;
  double most = 0, integral = 0, share = 0;
  for (const ExaminedView& v : views) {
    if (v.lost_below.empty()) continue;
    const std::vector<double> own = f.pdf(Directions(v.lost_below.size(), v.wo), v.lost_below);
    if (std::none_of(own.begin(), own.end(), [](double p) { return p > 0; })) continue;
    const double here = pdf_below(f, v.wo), drawn = v.draws_lost_below / v.draws;
    if (std::abs(here - drawn) > most) most = std::abs(here - drawn), integral = here, share = drawn, at = &v;
  }
  // Grid and chance: of an honest pdf below the horizon.
  if (!at || most <= 2e-3 + 0.05 * share + 6 * std::sqrt(share / at->draws)) return;
  d.findings.push_back(a_finding(
      "pdf_integral", "pdf_below_horizon",
      text("pdf is not 0 below the horizon: it integrates to %.3g there, where %.3g of the draws end, "
           "without a "
           "weight. Where f is 0 this changes no picture, but a test of pdf over the whole sphere fails",
           integral, share),
      {at->wo, at->lost_below[0], {}, 0, 0}, false));
  d.findings.back().figures = {{"integral_of_pdf_below", at->where, integral},
                               {"share_of_draws_below", at->where, share}};
}

}  // namespace reflectree::detail
