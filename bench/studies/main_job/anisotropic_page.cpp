// SPDX-License-Identifier: Apache-2.0
#include "anisotropic_page.hpp"

#include <algorithm>

#include "reflectree/text/printf_text.hpp"

namespace reflectree::study {

namespace {

using detail::text;

struct Limits {
  double kib, seconds;  // 0: none; processor seconds
};
Limits limits_of(const std::string& group) {
  if (group == name_of(Group::model)) return {512, 16};
  if (group == name_of(Group::baked_rgl)) return {2048, 60};
  return {0, 60};
}

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}
double largest(const std::vector<double>& v) { return v.empty() ? 0 : *std::max_element(v.begin(), v.end()); }

double least_p(const Measurement& m, const char* check) {
  double p = 1;
  for (const Verdict& v : m.verdicts) {
    if (v.check == check) p = std::min(p, v.p_value);
  }
  return p;
}

}  // namespace

std::vector<std::string> misses_of(const Measurement& m, const StudyOptions&) {
  std::vector<std::string> misses;
  const Limits limits = limits_of(m.group);
  const auto at_most = [&](const char* what, double value, double limit, const char* unit = "") {
    if (limit > 0 && value > limit)
      misses.push_back(text("%s %.3g%s, promised %.3g", what, value, unit, limit));
  };
  // Of each check the first line that failed, and how many did.
  std::vector<std::string> seen;
  for (const Verdict& v : m.verdicts) {
    if (v.passed || std::find(seen.begin(), seen.end(), v.check) != seen.end()) continue;
    seen.push_back(v.check);
    const auto same = [&](const Verdict& w) { return w.check == v.check; };
    const auto failed = [&](const Verdict& w) { return w.check == v.check && !w.passed; };
    misses.push_back(text("%td of %td: ", std::count_if(m.verdicts.begin(), m.verdicts.end(), failed),
                          std::count_if(m.verdicts.begin(), m.verdicts.end(), same)) +
                     v.line);
  }
  at_most("trials in the worst slab", m.worst_trials, 1.2505);
  // Tables keep what they state, as the checks above have it.
  if (m.group == name_of(Group::model)) at_most("stated error of the albedo", m.albedo_stated, 1.001e-4);
  at_most("overshooting mass", m.overshoot_estimate, 1e-6);
  at_most("one-shot variance, median", median(m.variance), 0.01);
  at_most("one-shot variance, worst at 0-80 degrees", largest(m.variance), 0.02);
  at_most("memory", m.kib, limits.kib, " KiB");
  at_most("build", m.build_processor_seconds, limits.seconds, " processor seconds");
  if (m.dead_exact > 0) misses.push_back(text("dead samples in exact mode, %.2g of all", m.dead_exact));
  if (m.none > 0) misses.push_back(text("refused samples, %.2g of all", m.none));
  return misses;
}

std::string anisotropic_page(const std::vector<Measurement>& all, const StudyOptions& options,
                             const std::string& command) {
  std::string out = "# Anisotropic materials, measured\n\nPrinted by `" + command + "`.\n\n";
  out += text(
      "%zu materials; %.0e samples per chi-square test for %d random viewers and %zu at 89 degrees; %d tests "
      "in "
      "the family, whose significance is %.0e. Overshooting mass by %.0e trials per material, trials of "
      "exact "
      "mode at %d viewers, half of them near grazing.\n\n",
      all.size(), double(options.samples), options.random_angles, options.angles_deg.size(), options.tests,
      options.significance, double(options.overshoot_trials), options.probed_wo);
  out +=
      "build: processor seconds of all threads. trials: worst and mean of the viewers. albedo: the relative "
      "error that the table states, and the largest that cubature found; tables that tell their albedo "
      "(Zemax) are judged to 1e-3, which is what this cubature sees of kinks. variance: one-shot, relative, "
      "median and worst at 0 to 80 degrees. p: the least of the tests of exact mode, and of one-shot mode "
      "against its own density. overshoot: its mass as the trials estimate it, and the 95 % bound; attack: "
      "the largest ratio to a bound that a search found. dead: share of one-shot samples where the function "
      "is 0.\n\n";
  out +=
      "| material | domain | slabs | leaves | KiB | build | trials | albedo | variance | p | overshoot "
      "| attack | dead | promises |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::string list;
  for (const Measurement& m : all) {
    const std::vector<std::string> misses = misses_of(m, options);
    const auto count = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
    out += text(
        "| %s | %s | %llu + %llu | %llu + %llu | %.0f | %.1f | %.3f, %.3f | %.1e, %.1e | %.4f, %.4f | %.2g, "
        "%.2g "
        "| %.1e, %.1e | %.3f | %.4f | %s |\n",
        m.material.c_str(), m.domain.c_str(), count(m.exact_slabs), count(m.one_shot_slabs),
        count(m.exact_leaves), count(m.one_shot_leaves), m.kib, m.build_processor_seconds, m.worst_trials,
        m.mean_trials, m.albedo_stated, m.albedo_missed, median(m.variance), largest(m.variance),
        least_p(m, "chi_square"), least_p(m, "chi_square_pdf"), m.overshoot_estimate, m.overshoot_upper,
        m.attack_ratio, m.dead_one_shot, misses.empty() ? "kept" : "**missed**");
    for (const std::string& miss : misses) list += "* " + m.material + ": " + miss + "\n";
    for (const std::string& note : m.notes) list += "* " + m.material + " says: " + note + "\n";
  }
  if (!list.empty()) out += "\n## What is missed\n\n" + list;
  return out;
}

}  // namespace reflectree::study
