// SPDX-License-Identifier: Apache-2.0
#include "promises.hpp"

#include <algorithm>
#include <functional>

#include "reflectree/text/printf_text.hpp"

namespace reflectree::study {

namespace {

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v.size() % 2 ? v[v.size() / 2] : 0.5 * (v[v.size() / 2 - 1] + v[v.size() / 2]);
}
double largest(const std::vector<double>& v) { return v.empty() ? 0 : *std::max_element(v.begin(), v.end()); }

struct Judge {
  const std::vector<Measurement>& all;
  std::vector<Promise> promises;

  std::vector<double> collect(const std::function<double(const Measurement&)>& value,
                              const std::string& group = "") const {
    std::vector<double> v;
    for (const Measurement& m : all) {
      if (group.empty() || m.group == group) v.push_back(value(m));
    }
    return v;
  }
  void at_most(const std::string& text, double value, double limit, const char* unit = "") {
    promises.push_back({text, detail::text("%.4g%s", value, unit), value <= limit});
  }
  // Every verdict of that name passed; names the materials where not.
  void every(const std::string& text, const std::string& check) {
    int count = 0, failed = 0;
    double least = 1;
    std::string where;
    for (const Measurement& m : all) {
      int here = 0;
      for (const Verdict& v : m.verdicts) {
        if (v.check != check) continue;
        ++count, here += !v.passed;
        least = std::min(least, v.p_value);
      }
      if (here > 0) where += (where.empty() ? ": " : ", ") + m.material;
      failed += here;
    }
    std::string measured = detail::text("%d tests, %d failed%s", count, failed, where.c_str());
    if (least < 1) measured += detail::text(", least p = %.2g", least);
    promises.push_back({text, measured, count > 0 && failed == 0});
  }
};

}  // namespace

std::vector<Promise> judge(const std::vector<Measurement>& all, const StudyOptions& options, bool timed) {
  Judge j{all, {}};
  j.every("exact: chi-square of the directions", "chi_square");
  std::vector<Verdict> unused;
  j.every("one-shot: chi-square against its own pdf", "chi_square_pdf");
  j.every("exact and one-shot: chi-square of the weighted counts", "chi_square_weights");
  j.every("one-shot: mean weight is the albedo", "mean_weight");
  j.every("albedo table: 1e-4 at random theta_o up to 89.9 deg, 1e-3 at 89.999 deg", "albedo_table");
  j.every("sum(V) accepted / trials is the albedo within four standard errors", "accepted_trials");
  j.every("sample_once: mean weight is the albedo within four standard errors", "sample_once");
  j.at_most("no dead samples, exact (share)", largest(j.collect([](auto& m) { return m.dead_exact; })), 0);
  j.at_most("no sample is refused (share)", largest(j.collect([](auto& m) { return m.none; })), 0);
  j.at_most("mean trials <= 1.25 for every wo", largest(j.collect([](auto& m) { return m.worst_trials; })),
            1.25);
  j.at_most(detail::text("overshoot mass <= 1e-6 (upper 95 %% bound, %.0e trials per material)",
                         double(options.overshoot_trials)),
            largest(j.collect([](auto& m) { return m.overshoot_upper; })), 1e-6);
  std::vector<double> variance, grazing;
  for (const Measurement& m : all) {
    if (m.group != "model" && m.group != "rgl") continue;
    variance.insert(variance.end(), m.variance.begin(), m.variance.end());
    grazing.push_back(m.variance_grazing);
  }
  j.at_most("one-shot variance, models and RGL, 0-80 deg: median <= 0.01", median(variance), 0.01);
  j.at_most("the same: worst <= 0.02", largest(variance), 0.02);
  j.at_most("the same at 89.9 deg: <= 0.03", largest(grazing), 0.03);
  const auto kib = j.collect([](auto& m) { return m.kib; });
  j.at_most("memory of a sampler: median <= 128 KiB", median(kib), 128, " KiB");
  j.at_most("the same: worst <= 1.5 MiB", largest(kib), 1536, " KiB");
  if (timed) {
    const auto seconds = [](const Measurement& m) { return m.build_seconds; };
    j.at_most("build on two cores, models: median <= 0.7 s", median(j.collect(seconds, "model")), 0.7, " s");
    j.at_most("the same: worst <= 2 s", largest(j.collect(seconds, "model")), 2, " s");
    j.at_most("build on two cores, RGL: median <= 3 s", median(j.collect(seconds, "rgl")), 3, " s");
    j.at_most("the same: worst <= 8 s", largest(j.collect(seconds, "rgl")), 8, " s");
  }
  return j.promises;
}

std::string to_markdown(const std::vector<Measurement>& all, const std::vector<Promise>& promises,
                        const StudyOptions& options, const std::string& command) {
  std::string out = "# The main job, measured\n\nPrinted by `" + command + "`.\n\n";
  out += detail::text(
      "%zu materials; %.0e samples per chi-square test at %zu fixed and %d random elevations per "
      "material; %d tests in the family, whose significance is %.0e.\n\n",
      all.size(), double(options.samples), options.angles_deg.size(), options.random_angles, options.tests,
      options.significance);
  out += "## Promises\n\n| promise | measured | verdict |\n|---|---|---|\n";
  for (const Promise& p : promises) {
    out += "| " + p.text + " | " + p.measured + " | " + (p.kept ? "kept" : "**broken**") + " |\n";
  }
  out +=
      "\n## Materials\n\n`p`: the least of the material's chi-square tests. trials: largest sum(V) over wo, "
      "and "
      "measured there. overshoot: the upper 95 % bound of its mass; attack: the largest ratio to a bound "
      "that "
      "a search found. variance: one-shot, relative, worst of 0-80 deg and at 89.9 deg. dead: share of "
      "one-shot samples where the function itself is 0.\n\n"
      "| material | domain | slabs | leaves | KiB | build s | p | failed | trials | overshoot | attack | "
      "variance | 89.9 deg | dead | study s "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Measurement& m : all) {
    double p = 1;
    int failed = 0;
    for (const Verdict& v : m.verdicts) p = std::min(p, v.p_value), failed += !v.passed;
    out += detail::text(
        "| %s | %s | %llu + %llu | %llu + %llu | %.0f | %.2f | %.2g | %d | %.3f, %.3f | %.1e | "
        "%.4f | %.4f | %.4f | %.4f | %.0f |\n",
        m.material.c_str(), m.domain.c_str(), static_cast<unsigned long long>(m.exact_slabs),
        static_cast<unsigned long long>(m.one_shot_slabs), static_cast<unsigned long long>(m.exact_leaves),
        static_cast<unsigned long long>(m.one_shot_leaves), m.kib, m.build_seconds, p, failed, m.worst_trials,
        m.measured_trials, m.overshoot_upper, m.attack_ratio, largest(m.variance), m.variance_grazing,
        m.dead_one_shot, m.seconds);
  }
  std::string failures;
  for (const Measurement& m : all) {
    for (const Verdict& v : m.verdicts) {
      if (!v.passed) failures += "* " + m.material + ": " + v.line + "\n";
    }
  }
  if (!failures.empty()) out += "\n## Failures\n\n" + failures;
  return out;
}

}  // namespace reflectree::study
