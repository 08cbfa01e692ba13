// SPDX-License-Identifier: Apache-2.0
#include "pointwise.hpp"

#include <algorithm>
#include <numeric>

#include "explain_draws.hpp"
#include "findings.hpp"

namespace reflectree::detail {
namespace {

constexpr double tolerance = 1e-3;       // relative
constexpr double max_exceptions = 3e-3;  // share of draws: borders of leaves and cells in float

// Rounding makes what was computed from the unrounded cosine another than what the direction says.
void blame_rounding(const Diagnosis& d, Finding& finding) {
  const bool rounded = std::any_of(d.findings.begin(), d.findings.end(),
                                   [](const Finding& x) { return x.cause == "float_precision"; });
  if (rounded && finding.cause == "unexplained") finding.words += "; it may follow from the rounded cosines";
}

}  // namespace

PointwiseVerdict check_pointwise(const Functions& f, const Pointwise& draws,
                                 std::span<const ExaminedView> views, const DensityVerdict& density,
                                 Diagnosis& d) {
  PointwiseVerdict verdict;
  if (draws.size() == 0) return verdict;
  const AroundDraws a(f, draws);
  bool own_pdf_right = false;  // sample's, where pdf() is not
  Ranges truth;
  if (density.truth) truth = a.truth_ranges(density);
  if (f.has_pdf()) {
    const Ranges plain = a.pdf_ranges();
    const double off = 1 - share(plain, draws.pdf, tolerance);
    d.checks.push_back(
        limited("pdf_agrees", off, max_exceptions, "share of draws whose pdf is not pdf(wo, wi)"));
    verdict.pdf_agrees = off <= max_exceptions;
    own_pdf_right =
        !verdict.pdf_agrees && !density.holds && !truth.empty() && share(truth, draws.pdf, 5e-3) >= explains;
    if (own_pdf_right) {
      for (Finding& x : d.findings) {
        if (x.check == "chi_square_pdf" || x.check == "pdf_integral")
          x.words += "; the pdf that sample returns is right";
      }
    } else if (!verdict.pdf_agrees) {
      Finding finding;
      finding.check = "pdf_agrees";
      explain_pdf(a, views, finding);
      // Where the density is explained by the same mistake, one finding is enough.
      std::size_t worst = 0;
      double most = 0;
      for (std::size_t i = 0; i < draws.size(); ++i) {
        const double e = relative_error(plain[i], draws.pdf[i]);
        if (e > most && e < 1e6) most = e, worst = i;
      }
      finding.evidence = {draws.wo[worst], draws.wi[worst], "pdf of sample(wo)", draws.pdf[worst],
                          plain[worst].hi};
      finding.figures = {{"share_of_draws", "", off}};
      blame_rounding(d, finding);
      d.findings.push_back(std::move(finding));
    }
  }
  const bool any_pdf = std::any_of(draws.pdf.begin(), draws.pdf.end(), [](double p) { return p > 0; });
  if (!any_pdf || f.value_kind() == ValueKind::none) return verdict;

  std::vector<std::size_t> own(f.channels());
  std::iota(own.begin(), own.end(), std::size_t{0});
  const Values one(draws.size(), 1);
  std::size_t worst = 0;
  const Values claimed = a.claimed(draws.pdf);
  const double off = 1 - a.weight_share(claimed, one, own, a.f_cos, tolerance, &worst);
  d.checks.push_back(limited("weight_agrees", off, max_exceptions,
                             "share of draws whose weight * pdf is not f cos_theta_i"));
  verdict.weight_agrees = off <= max_exceptions;
  if (verdict.weight_agrees) return verdict;
  // A weight that is right for the true density is right.
  Values true_density(draws.size());
  if (!truth.empty()) {
    for (std::size_t i = 0; i < draws.size(); ++i) true_density[i] = 0.5 * (truth[i].lo + truth[i].hi);
    if (a.weight_share(a.claimed(true_density), one, own, a.f_cos, 5e-3) >= explains) {
      verdict.weight_explained = true;
      return verdict;
    }
  }
  Finding finding;
  finding.check = "weight_agrees";
  verdict.weight_explained = explain_weight(a, claimed, draws.pdf, finding);
  if (!verdict.weight_explained && !truth.empty()) {
    verdict.weight_explained = explain_weight(a, a.claimed(true_density), true_density, finding);
  }
  if (!verdict.weight_explained) {
    finding.cause = "unexplained";
    finding.words = "weight * pdf is not f cos_theta_i, and no hypothesis explains what it is";
  }
  const std::size_t k = worst * f.channels();
  finding.evidence = {draws.wo[worst], draws.wi[worst], "weight * pdf, channel 0", claimed[k], a.f_cos[k].hi};
  finding.figures = {{"share_of_draws", "", off}};
  blame_rounding(d, finding);
  d.findings.push_back(std::move(finding));
  return verdict;
}

}  // namespace reflectree::detail
