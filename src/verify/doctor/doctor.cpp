// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/doctor.hpp"

#include <algorithm>
#include <cstdio>

#include "below.hpp"
#include "density.hpp"
#include "findings.hpp"
#include "kinds.hpp"
#include "light.hpp"
#include "physics.hpp"
#include "pointwise.hpp"
#include "reflectree/error.hpp"
#include "reflectree/verify/significance.hpp"
#include "structure.hpp"
#include "values.hpp"

namespace reflectree {
namespace {

using namespace detail;

void demand(bool holds, const Patient& p, const char* what, const char* how) {
  if (!holds) throw Error(what, p.name, how);
}

// Whether a cause that begins so has been found.
bool named(const Diagnosis& d, std::string_view cause) {
  return std::any_of(d.findings.begin(), d.findings.end(),
                     [&](const Finding& f) { return f.cause.starts_with(cause); });
}

void judge_below(std::span<const ExaminedView> views, Diagnosis& d) {
  const ExaminedView* at = nullptr;
  double most = 0;
  for (const ExaminedView& v : views) {
    const double share = v.below / v.draws;
    d.checks.push_back(
        limited("above", share, 0, "share of draws below the horizon that carry a weight", v.where));
    if (share > most) most = share, at = &v;
  }
  if (!at) return;
  char words[160];
  std::snprintf(words, sizeof words, "%.3g %% of the directions lie below the horizon and carry a weight",
                100 * most);
  d.findings.push_back(a_finding("above", "draws_below_horizon", words, {at->wo, at->a_below, {}, 0, 0}));
}

void judge_lost(std::span<const ExaminedView> views, Diagnosis& d) {
  for (const ExaminedView& v : views) {
    const bool values = v.broken == 0 && v.broken_values > 0;
    const double count = values ? v.broken_values : v.broken;
    d.checks.push_back(limited("finite", count, 0, "draws that are not finite", v.where));
    if (count > 0 && !named(d, "not_finite")) {
      char words[120];
      std::snprintf(words, sizeof words, "%s of %.3g %% of the draws is NaN or infinite",
                    values ? "the value" : "the direction or the pdf", 100 * count / v.draws);
      d.findings.push_back(a_finding("finite", "not_finite", words, {v.wo, {}, {}, 0, 0}));
    }
    if (v.draws > 0 && v.broken == 0 && v.lost == v.draws && v.albedo > 1e-3) {
      char words[120];
      std::snprintf(words, sizeof words, "no direction at all is drawn, where f reflects %.3g of the light",
                    v.albedo);
      d.findings.push_back(a_finding("above", "never_draws", words, {v.wo, {}, {}, 0, 0}));
      return;
    }
  }
}

}  // namespace

DoctorOptions doctor_options(DoctorEffort effort) {
  DoctorOptions o;
  if (effort == DoctorEffort::quick) {
    o.theta_o_deg = {20, 70}, o.random_viewers = 1, o.samples = 50'000, o.bins = 128;
    o.pointwise_viewers = 16, o.pointwise_draws = 50;
  }
  if (effort == DoctorEffort::thorough) {
    o.theta_o_deg = {0, 15, 30, 45, 60, 70, 80, 86, 89}, o.random_viewers = 6, o.samples = 2'000'000,
    o.bins = 512;
    o.pointwise_viewers = 128, o.pointwise_draws = 200;
  }
  return o;
}

bool Diagnosis::healthy() const {
  return std::none_of(findings.begin(), findings.end(), [](const Finding& f) { return f.fault; });
}

Diagnosis doctor(const Patient& patient, const DoctorOptions& options, const Host& host) {
  demand(bool(patient.eval), patient, "there is no eval", "the doctor needs eval and sample");
  demand(bool(patient.sample), patient, "there is no sample", "the doctor needs eval and sample");
  demand(patient.channels >= 1 && patient.channels <= max_channels, patient,
         "an impossible number of channels", "give it 1 to 256");
  demand(!options.theta_o_deg.empty() || options.random_viewers > 0, patient, "no viewer to look from",
         "give some theta_o_deg");
  demand(options.samples >= 20'000 && options.samples <= 200'000'000 && options.bins >= 16 &&
             options.bins <= 4096,
         patient, "impossible options", "give at least 20000 samples and 16 to 4096 bins");

  Diagnosis d;
  d.subject = patient.name;
  host.stage("values");
  const Kinds kinds = settle_kinds(patient, options.seed);
  d.conventions = kinds.sentences;
  const Functions f(patient, kinds.eval, kinds.value);
  check_values(f, options.seed, d);
  check_repeatable(f, options.seed, d);

  const std::vector<ExaminedView> views = examine_views(f, options, host);
  const double level = sidak(options.family_significance, int(4 * views.size() + 3));
  judge_below(views, d);
  judge_lost(views, d);
  const bool degenerate = check_structure(f, views, level, d);
  const DensityVerdict density = judge_density(f, views, level, degenerate, host, d);
  const Pointwise draws = draw_pointwise(f, options.pointwise_viewers, options.pointwise_draws, options.seed);
  check_pointwise(f, draws, views, density, d);
  check_support(f, views, d);
  const bool light = check_light(f, views, level, d);
  // What was found before explains a wrong mean; if nothing was, it is a finding of its own.
  if (!light && d.healthy()) {
    d.findings.push_back(
        a_finding("light", "biased", "weights do not add up to f cos_theta_i: the sampler is biased"));
    for (const ExaminedView& v : views) {
      double sum = 0;
      for (const double x : v.light) sum += x;
      d.findings.back().figures.push_back({"mean_weight_over_albedo", v.where, sum / v.draws / v.albedo});
    }
  }
  remark_on_pdf_below(f, views, d);
  remark_on_physics(f, views, options.seed, d);
  measure_quality(f, views, d);
  for (const ExaminedView& v : views) d.views.push_back(v);
  host.progress(1);
  return d;
}

std::string to_text(const Finding& finding) {
  std::string out = std::string(finding.fault ? "FAULT   " : "remark  ") + finding.words + "\n        [" +
                    finding.check + ", " + finding.cause + "]";
  char buffer[240];
  for (const VerifyFigure& x : finding.figures) {
    std::snprintf(buffer, sizeof buffer, "  %s %.5g%s%s", x.name.c_str(), x.value,
                  x.where.empty() ? "" : " at ", x.where.c_str());
    out += buffer;
  }
  out += "\n";
  const Evidence& e = finding.evidence;
  if (e.wo.z == 0 && e.wo.x == 0) return out;
  out += "        wo " + in_words(e.wo) + (e.wi == Direction{} ? "" : ", wi " + in_words(e.wi));
  if (!e.quantity.empty()) {
    std::snprintf(buffer, sizeof buffer, ": %s is %.6g, expected %.6g", e.quantity.c_str(), e.found,
                  e.expected);
    out += buffer;
  }
  return out + "\n";
}

}  // namespace reflectree
