// SPDX-License-Identifier: Apache-2.0
#include "explain_draws.hpp"

#include <algorithm>
#include <numeric>

#include "findings.hpp"

namespace reflectree::detail {
namespace {

// pdf of the lobe alone that was chosen: the mean of 1 / pdf over the draws of a bin is its solid angle
// (p_k), or twice that for two lobes (w_k p_k). 0: neither.
int lobes_in(std::span<const ExaminedView> views) {
  std::vector<double> ratio;
  for (const ExaminedView& v : views) {
    std::vector<double> inverse(v.count.size()), area(v.count.size());
    for (std::size_t i = 0; i < v.wi.size(); ++i) inverse[v.bin[i]] += v.pdf[i] > 0 ? 1 / v.pdf[i] : 0;
    for (std::size_t i = 0; i < v.nodes.wi.size(); ++i) area[v.nodes.bin[i]] += v.nodes.solid_angle[i];
    for (std::size_t b = 0; b < area.size(); ++b) {
      if (v.count[b] > 300 && area[b] > 0) ratio.push_back(inverse[b] / v.draws / area[b]);
    }
  }
  if (ratio.size() < 20) return 0;
  std::sort(ratio.begin(), ratio.end());
  const double middle = ratio[ratio.size() / 2], low = ratio[ratio.size() / 10],
               high = ratio[ratio.size() * 9 / 10];
  for (const int k : {1, 2, 3}) {
    if (std::abs(middle / k - 1) < 0.06 && low > 0.75 * k && high < 1.3 * k) return k;
  }
  return 0;
}

}  // namespace

void explain_pdf(const AroundDraws& a, std::span<const ExaminedView> views, Finding& finding) {
  const Values& ps = a.draws.pdf;
  for (const DensityHypothesis& h : density_hypotheses()) {
    if (share(a.pdf_ranges(&h, true), ps, 2e-3) < explains) continue;
    finding.cause = h.cause;
    finding.words = std::string("in the pdf that sample returns, while pdf() is right: ") + h.words;
    return;
  }
  const Ranges plain = a.pdf_ranges();
  Values ratio;
  for (std::size_t i = 0; i < ps.size(); ++i) {
    if (plain[i].hi > 0) ratio.push_back(ps[i] / (0.5 * (plain[i].lo + plain[i].hi)));
  }
  std::sort(ratio.begin(), ratio.end());
  const double middle = ratio.empty() ? 0 : ratio[ratio.size() / 2];
  Values scaled = ps;
  for (double& x : scaled) x /= middle;
  if (middle > 0 && share(plain, scaled, 2e-3) >= explains) {
    finding.cause = "sample_pdf_scaled";
    finding.words = text("the pdf that sample returns is %.5g times pdf(wo, wi)", middle);
  } else if (const int k = lobes_in(views)) {
    finding.cause = "lobe_pdf";
    finding.words = k == 1
                        ? "sample returns the pdf of the lobe that it chose: it leaves out the choice of the "
                          "lobe and the other lobes"
                        : "sample returns the chosen lobe's share of the pdf: it leaves out the other lobes";
  } else {
    finding.cause = "unexplained";
    finding.words = "sample returns another pdf than pdf(wo, wi), and no hypothesis explains which";
  }
}

bool explain_weight(const AroundDraws& a, const Values& claimed, const Values& density, Finding& finding) {
  std::vector<std::size_t> own(a.channels);
  std::iota(own.begin(), own.end(), std::size_t{0});
  const auto named = [&](const char* cause, const std::string& words) {
    finding.cause = cause, finding.words = words;
    return true;
  };
  for (const WeightHypothesis& h : weight_hypotheses()) {
    Values factor;
    for (std::size_t i = 0; i < a.draws.size(); ++i) factor.push_back(h.factor(a.pair(i), density[i]));
    if (a.weight_share(claimed, factor, own, a.f_cos, 2e-3) >= explains) return named(h.cause, h.words);
  }
  const Values one(a.draws.size(), 1);
  if (a.channels > 1 && a.channels <= 4) {
    // Any channel for any other.
    std::vector<std::size_t> from(a.channels);
    const auto possibilities = std::size_t(std::pow(double(a.channels), double(a.channels)));
    for (std::size_t code = 0; code < possibilities; ++code) {
      for (std::size_t c = 0, rest = code; c < a.channels; ++c, rest /= a.channels)
        from[c] = rest % a.channels;
      if (from == own || a.weight_share(claimed, one, from, a.f_cos, 2e-3) < explains) continue;
      std::string list;
      for (const std::size_t c : from) list += (list.empty() ? "" : ", ") + std::to_string(c);
      return named("wrong_channel", "the weight's channels are f's channels " + list + " in this order");
    }
  }
  Values ratio;
  for (std::size_t k = 0; k < claimed.size(); ++k) {
    const Range& r = a.f_cos[k];
    if (r.hi > 0 && claimed[k] > 0) ratio.push_back(claimed[k] / (0.5 * (r.lo + r.hi)));
  }
  std::sort(ratio.begin(), ratio.end());
  const double middle = ratio.empty() ? 0 : ratio[ratio.size() / 2];
  if (middle > 0 && a.weight_share(claimed, Values(a.draws.size(), middle), own, a.f_cos, 2e-3) >= explains) {
    return named("weight_scaled", text("the weight is %.5g times f cos_theta_i / pdf", middle));
  }
  if (a.weight_share(claimed, one, own, a.f_cos_at(a.wi, a.wo), 2e-3) >= explains) {
    return named("f_swapped", "the weight takes f with wi and wo exchanged, and f is not reciprocal");
  }
  const auto turned = [&](float x, float y) {
    Directions wi = a.wi;
    for (Direction& w : wi) w.x *= x, w.y *= y;
    return a.weight_share(claimed, one, own, a.f_cos_at(a.wo, wi), 2e-3) >= explains;
  };
  if (turned(-1, -1)) return named("f_half_turn", "the weight takes f half a turn away: phi is off by pi");
  if (turned(1, -1))
    return named("f_mirrored", "the weight takes f at the mirror image: the sign of phi is lost or changed");
  if (turned(-1, 1))
    return named("f_mirrored", "the weight takes f at the mirror image: the sign of x is changed");
  return false;
}

}  // namespace reflectree::detail
