// SPDX-License-Identifier: Apache-2.0
#include "doctor_pointwise.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "doctor_hypotheses.hpp"
#include "doctor_values.hpp"
#include "neighbours.hpp"

namespace reflectree::detail {
namespace {

constexpr double tolerance = 1e-3;       // relative
constexpr double max_exceptions = 3e-3;  // share of draws: borders of leaves and cells in float
constexpr double explains = 0.98;        // share of draws that a hypothesis must agree with
constexpr double dim = 1e-5;             // of the brightest channel: what a dim one may be off

using Values = std::vector<double>;
using Ranges = std::vector<Range>;

std::string text(const char* format, double a, double b = 0) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, a, b);
  return buffer;
}

double relative_error(const Range& r, double x) {
  if (!std::isfinite(x)) return 1e9;
  const double lo = r.lo, hi = r.hi;
  return x < lo ? (lo - x) / std::max(lo, 1e-30) : x > hi ? (x - hi) / std::max(hi, 1e-30) : 0;
}

class Pointwise_ {
 public:
  Pointwise_(const Functions& f, const Pointwise& draws) : f_(f), p_(draws) {
    for (std::size_t i = 0; i < p_.size(); ++i) {
      for (const Vec3<double>& w : neighbours(p_.wi[i])) {
        wo_.push_back(p_.wo[i]);
        around_.push_back({float(w.x), float(w.y), float(w.z)});
      }
    }
    channels_ = f.channels();
    f_cos_ = ranges(f.f_cos(wo_, around_), channels_);
  }

  DirectionPair pair(std::size_t i) const {
    const auto wide = [](Direction w) { return Vec3<double>{double(w.x), double(w.y), double(w.z)}; };
    return {wide(p_.wo[i]), wide(p_.wi[i])};
  }
  Ranges pdf_ranges(const DensityHypothesis* h = nullptr, bool inverse = false) const {
    Directions a = wo_, b = around_;
    for (std::size_t k = 0; h && h->turn && k < a.size(); ++k) {
      const DirectionPair t = h->turn({{a[k].x, a[k].y, a[k].z}, {b[k].x, b[k].y, b[k].z}});
      a[k] = {float(t.wo.x), float(t.wo.y), float(t.wo.z)},
      b[k] = {float(t.wi.x), float(t.wi.y), float(t.wi.z)};
    }
    Values pdf = f_.pdf(a, b);
    for (std::size_t k = 0; h && h->factor && k < pdf.size(); ++k) {
      const double g =
          h->factor({{wo_[k].x, wo_[k].y, wo_[k].z}, {around_[k].x, around_[k].y, around_[k].z}});
      pdf[k] *= inverse ? 1 / g : g;
    }
    return ranges(pdf, 1);
  }
  Ranges truth_ranges(const DensityVerdict& density) const { return ranges(density.truth(wo_, around_), 1); }

  static double share(const Ranges& r, const Values& x, double tolerance_) {
    double agree = 0;
    for (std::size_t i = 0; i < x.size(); ++i) agree += relative_error(r[i], x[i]) <= tolerance_;
    return x.empty() ? 1 : agree / double(x.size());
  }

  // value -> f cos_theta_i as the draw has it: weight times the density in use.
  Values claimed(const Values& density) const {
    const Values f_cos =
        f_.value_kind() == ValueKind::none ? f_.f_cos(p_.wo, p_.wi) : Values(p_.value.size());
    Values claimed(p_.value.size());
    for (std::size_t i = 0; i < p_.size(); ++i) {
      for (std::size_t c = 0; c < channels_; ++c) {
        const std::size_t k = i * channels_ + c;
        claimed[k] = f_.weight({p_.wi[i], p_.pdf[i], true}, p_.value[k], f_cos[k]) * density[i];
      }
    }
    return claimed;
  }
  // Share of draws whose channels all agree with f cos_theta_i times a factor; `from` permutes channels.
  double weight_share(const Values& claimed, const Values& factor, const std::vector<std::size_t>& from,
                      const Ranges& f_cos, double tolerance_, std::size_t* worst = nullptr) const {
    double agree = 0, most = 0;
    for (std::size_t i = 0; i < p_.size(); ++i) {
      double brightest = 0, off = 0;
      for (std::size_t c = 0; c < channels_; ++c)
        brightest = std::max(brightest, f_cos[i * channels_ + c].hi);
      for (std::size_t c = 0; c < channels_; ++c) {
        const Range& r = f_cos[i * channels_ + from[c]];
        const double x = claimed[i * channels_ + c] / factor[i];
        if (std::abs(x - r.hi) <= dim * brightest || std::abs(x - r.lo) <= dim * brightest) continue;
        off = std::max(off, relative_error(r, x));
      }
      agree += off <= tolerance_;
      if (off > most && off < 1e6 && worst) most = off, *worst = i;
    }
    return p_.size() == 0 ? 1 : agree / double(p_.size());
  }
  Ranges f_cos_at(const Directions& wo, const Directions& wi) const {
    // f there, the cosine of the draw.
    Values v = f_.f_cos(wo, wi);
    for (std::size_t k = 0; k < wi.size(); ++k) {
      const double scale = std::max(double(around_[k].z), 0.) / std::max(double(wi[k].z), 1e-9);
      for (std::size_t c = 0; c < channels_; ++c) v[k * channels_ + c] *= scale;
    }
    return ranges(v, channels_);
  }

  const Functions& f_;
  const Pointwise& p_;
  std::size_t channels_ = 1;
  Directions wo_, around_;
  Ranges f_cos_;

 private:
  static Ranges ranges(const Values& v, std::size_t channels) {
    constexpr std::size_t n = std::tuple_size_v<decltype(neighbours({}))>;
    Ranges r(v.size() / n);
    for (std::size_t k = 0; k < v.size(); ++k) r[k / (n * channels) * channels + k % channels].add(v[k]);
    return r;
  }
};

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

struct Worst {
  std::size_t at = 0;
  double off = 0;
};

void explain_pdf(const Pointwise_& a, std::span<const ExaminedView> views, Finding& finding) {
  const Values& ps = a.p_.pdf;
  for (const DensityHypothesis& h : density_hypotheses()) {
    if (Pointwise_::share(a.pdf_ranges(&h, true), ps, 2e-3) < explains) continue;
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
  if (middle > 0 && Pointwise_::share(plain, scaled, 2e-3) >= explains) {
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

bool explain_weight(const Pointwise_& a, const Values& claimed, const Values& density, Finding& finding) {
  std::vector<std::size_t> own(a.channels_);
  std::iota(own.begin(), own.end(), std::size_t{0});
  const auto named = [&](const char* cause, const std::string& words) {
    finding.cause = cause, finding.words = words;
    return true;
  };
  for (const WeightHypothesis& h : weight_hypotheses()) {
    Values factor;
    for (std::size_t i = 0; i < a.p_.size(); ++i) factor.push_back(h.factor(a.pair(i), density[i]));
    if (a.weight_share(claimed, factor, own, a.f_cos_, 2e-3) >= explains) return named(h.cause, h.words);
  }
  const Values one(a.p_.size(), 1);
  if (a.channels_ > 1 && a.channels_ <= 4) {
    // Any channel for any other.
    std::vector<std::size_t> from(a.channels_);
    const auto possibilities = std::size_t(std::pow(double(a.channels_), double(a.channels_)));
    for (std::size_t code = 0; code < possibilities; ++code) {
      for (std::size_t c = 0, rest = code; c < a.channels_; ++c, rest /= a.channels_)
        from[c] = rest % a.channels_;
      if (from == own || a.weight_share(claimed, one, from, a.f_cos_, 2e-3) < explains) continue;
      std::string list;
      for (const std::size_t c : from) list += (list.empty() ? "" : ", ") + std::to_string(c);
      return named("wrong_channel", "the weight's channels are f's channels " + list + " in this order");
    }
  }
  Values ratio;
  for (std::size_t k = 0; k < claimed.size(); ++k) {
    const Range& r = a.f_cos_[k];
    if (r.hi > 0 && claimed[k] > 0) ratio.push_back(claimed[k] / (0.5 * (r.lo + r.hi)));
  }
  std::sort(ratio.begin(), ratio.end());
  const double middle = ratio.empty() ? 0 : ratio[ratio.size() / 2];
  if (middle > 0 && a.weight_share(claimed, Values(a.p_.size(), middle), own, a.f_cos_, 2e-3) >= explains) {
    return named("weight_scaled", text("the weight is %.5g times f cos_theta_i / pdf", middle));
  }
  if (a.weight_share(claimed, one, own, a.f_cos_at(a.around_, a.wo_), 2e-3) >= explains) {
    return named("f_swapped", "the weight takes f with wi and wo exchanged, and f is not reciprocal");
  }
  const auto turned = [&](float x, float y) {
    Directions wi = a.around_;
    for (Direction& w : wi) w.x *= x, w.y *= y;
    return a.weight_share(claimed, one, own, a.f_cos_at(a.wo_, wi), 2e-3) >= explains;
  };
  if (turned(-1, -1)) return named("f_half_turn", "the weight takes f half a turn away: phi is off by pi");
  if (turned(1, -1))
    return named("f_mirrored", "the weight takes f at the mirror image: the sign of phi is lost or changed");
  if (turned(-1, 1))
    return named("f_mirrored", "the weight takes f at the mirror image: the sign of x is changed");
  return false;
}

}  // namespace

PointwiseVerdict check_pointwise(const Functions& f, const Pointwise& draws,
                                 std::span<const ExaminedView> views, const DensityVerdict& density,
                                 Diagnosis& d) {
  PointwiseVerdict verdict;
  if (draws.size() == 0) return verdict;
  const Pointwise_ a(f, draws);
  bool own_pdf_right = false;  // sample's, where pdf() is not
  Ranges truth;
  if (density.truth) truth = a.truth_ranges(density);
  if (f.has_pdf()) {
    const Ranges plain = a.pdf_ranges();
    const double off = 1 - Pointwise_::share(plain, draws.pdf, tolerance);
    d.checks.push_back(
        limited("pdf_agrees", off, max_exceptions, "share of draws whose pdf is not pdf(wo, wi)"));
    verdict.pdf_agrees = off <= max_exceptions;
    own_pdf_right = !verdict.pdf_agrees && !density.holds && !truth.empty() &&
                    Pointwise_::share(truth, draws.pdf, 5e-3) >= explains;
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
  const double off = 1 - a.weight_share(claimed, one, own, a.f_cos_, tolerance, &worst);
  d.checks.push_back(limited("weight_agrees", off, max_exceptions,
                             "share of draws whose weight * pdf is not f cos_theta_i"));
  verdict.weight_agrees = off <= max_exceptions;
  if (verdict.weight_agrees) return verdict;
  // A weight that is right for the true density is right.
  Values true_density(draws.size());
  if (!truth.empty()) {
    for (std::size_t i = 0; i < draws.size(); ++i) true_density[i] = 0.5 * (truth[i].lo + truth[i].hi);
    if (a.weight_share(a.claimed(true_density), one, own, a.f_cos_, 5e-3) >= explains) {
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
  finding.evidence = {draws.wo[worst], draws.wi[worst], "weight * pdf, channel 0", claimed[k],
                      a.f_cos_[k].hi};
  finding.figures = {{"share_of_draws", "", off}};
  d.findings.push_back(std::move(finding));
  return verdict;
}

}  // namespace reflectree::detail
