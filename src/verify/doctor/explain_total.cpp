// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "below.hpp"
#include "density_search.hpp"
#include "findings.hpp"
#include "hypotheses.hpp"
#include "reflectree/verify/significance.hpp"

namespace reflectree::detail {
namespace {

// The integral of pdf below the horizon for the viewer whose integral above is least.
double most_below(const DensitySearch& s) {
  const ExaminedView* at = nullptr;
  for (const ExaminedView& v : s.views) {
    if (!v.wi.empty() && (!at || v.pdf_integral < at->pdf_integral)) at = &v;
  }
  return pdf_below(s.f, at->wo);
}

}  // namespace

Explanation explain_total(const DensitySearch& s) {
  std::vector<double> factor, tolerance;
  double least_sum = 1e9, most_sum = 0, most_lost = 0, nearest_normal = 1;
  float highest = 0;
  for (const ExaminedView& v : s.views) {
    if (v.wi.empty()) continue;
    if (!s.fits(fit_of(v, v.pdf_mass, true))) return {};
    const double lost = (v.lost + v.below) / v.draws;
    factor.push_back(v.pdf_integral / (1 - lost));
    tolerance.push_back(integral_tolerance(v, normal_two_sided_quantile(s.level)) / (1 - lost));
    least_sum = std::min(least_sum, v.pdf_integral + lost);
    most_sum = std::max(most_sum, v.pdf_integral + lost);
    most_lost = std::max(most_lost, lost);
    if (v.wo.z > highest) highest = v.wo.z, nearest_normal = factor.back();
  }
  if (factor.empty()) return {};
  const auto [least, most] = std::minmax_element(factor.begin(), factor.end());
  const double middle = 0.5 * (*least + *most);
  bool constant = true;
  for (std::size_t i = 0; i < factor.size(); ++i) {
    constant = constant &&
               std::abs(factor[i] - middle) <= std::min(tolerance[i] * middle, 0.25 * std::abs(middle - 1));
  }
  Explanation e;
  if (constant) {
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
  // Whoever draws again loses nothing, and makes the density larger where the lobe reaches below the horizon: not
  // about the normal, or as pdf itself says.
  const double missing = 1 - *least;
  if (*most < 1.003 && most_lost < 1e-3) {
    const double below = most_below(s);
    const bool as_pdf_says = std::abs(below - missing) < 0.5 * missing;
    const bool towards_grazing = missing > 5e-3 && 1 - nearest_normal < 0.3 * missing;
    if (as_pdf_says || towards_grazing) {
      e.cause = "below_horizon";
      e.words = text(
          "up to %.2g %% of the density lies below the horizon: directions there are drawn again, and the "
          "pdf does not know",
          100 * missing);
      if (below > 0) e.words += text(" (where pdf gives %.2g %%)", 100 * below);
      return e;
    }
  }
  e.cause = "pdf_normalisation";
  e.words = text(
      "the pdf has the shape of the density and a wrong factor that depends on wo: with the lost draws "
      "it adds up to %.4f to %.4f where it should to 1",
      least_sum, most_sum);
  return e;
}

}  // namespace reflectree::detail
