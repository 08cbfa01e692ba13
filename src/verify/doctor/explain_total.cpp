// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "density_search.hpp"
#include "findings.hpp"
#include "hypotheses.hpp"

namespace reflectree::detail {
namespace {

// The integral of pdf below the horizon for the viewer whose integral above is least.
double most_below(const DensitySearch& s) {
  const ExaminedView* at = nullptr;
  for (const ExaminedView& v : s.views) {
    if (!v.wi.empty() && (!at || v.pdf_integral < at->pdf_integral)) at = &v;
  }
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
  for (const double p : s.f.pdf(Directions(wi.size(), at->wo), wi)) total += sane_or_zero(p);
  return total * 2 * pi_v<double> / double(wi.size());
}

}  // namespace

Explanation explain_total(const DensitySearch& s) {
  std::vector<double> factor;
  double least_integral = 1e9, most_integral = 0;
  for (const ExaminedView& v : s.views) {
    if (v.wi.empty()) continue;
    if (!s.fits(fit_of(v, v.pdf_mass, true))) return {};
    factor.push_back(v.pdf_integral / (1 - (v.lost + v.below) / v.draws));
    least_integral = std::min(least_integral, v.pdf_integral),
    most_integral = std::max(most_integral, v.pdf_integral);
  }
  if (factor.empty()) return {};
  const auto [least, most] = std::minmax_element(factor.begin(), factor.end());
  const double middle = 0.5 * (*least + *most);
  Explanation e;
  if (*most - *least < 0.008 * middle) {
    const std::string name = name_of_factor(middle, 2e-3);
    e.cause = "pdf_scaled";
    e.words = name.empty() ? text("the pdf is the density times %.4g: it does not integrate to 1", middle)
                           : "the pdf is the density times " + name + ": it does not integrate to 1";
    e.truth = [f = s.f, middle](std::span<const Direction> wo, std::span<const Direction> wi) {
      std::vector<double> pdf = f.pdf(wo, wi);
      for (double& p : pdf) p /= middle;
      return pdf;
    };
    return e;
  }
  if (*most < 1.003) {
    const double missing = 1 - *least, below = most_below(s);
    e.cause = "below_horizon";
    e.words = text(
        "up to %.2g %% of the density lies below the horizon: directions there are drawn again, and the "
        "pdf does not know",
        100 * missing);
    if (below > 0) e.words += text(" (where pdf gives %.2g %%)", 100 * below);
    return e;
  }
  e.cause = "pdf_normalisation";
  e.words = text("the pdf has the shape of the density and integrates to %.4g to %.4g, depending on wo",
                 least_integral, most_integral);
  return e;
}

}  // namespace reflectree::detail
