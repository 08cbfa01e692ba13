// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "reflectree/peers/registry.hpp"
#include "reflectree/study/report.hpp"

namespace reflectree::pictures {

namespace {

// Path tracing shows every sampler; the others those that stand for a family each.
constexpr const char* few[] = {"one-shot", "exact",        "paper",       "cosine",    "proxy",
                               "textbook", "adaptive-cdf", "alias-table", "warp-chain"};

std::vector<double> collected(const Cells& cells, double (*figure)(const PictureCell&)) {
  std::vector<double> x;
  for (const PictureCell* c : cells) x.push_back(figure(*c));
  return x;
}

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return (x[(x.size() - 1) / 2] + x[x.size() / 2]) / 2;
}

Table table_of(const Results& results, const Plan& plan, const std::string& scene,
               const std::string& method) {
  Table t{{"sampler", "relMSE at equal samples", "median of seeds", "without 0.1 % of the pixels",
           "CPU s (*)", "samples in our time", "relMSE there, without 0.1 % (*)", plan.ours + " = 1 (*)"},
          {}};
  const Cells ours = results.of(scene, method, plan.ours);
  for (const SamplerInfo& info : samplers()) {
    const Cells cells = results.of(scene, method, info.name);
    if (cells.empty()) continue;
    const auto all = collected(cells, [](const PictureCell& c) { return c.equal.error.all; });
    t.rows.push_back(
        {std::string(info.name), shown(mean_of(all)), shown(median(all)),
         shown(mean_of(collected(cells, [](const PictureCell& c) { return c.equal.error.trimmed; }))),
         shown(median(collected(cells, [](const PictureCell& c) { return c.equal.seconds; }))),
         std::to_string(cells.front()->timed.samples),
         shown(mean_of(collected(cells, [](const PictureCell& c) { return c.timed.error.trimmed; }))),
         ours.empty() ? "–" : shown(ratio_at_time(cells, ours))});
  }
  return t;
}

}  // namespace

std::vector<std::string> methods() { return {"path", "recursive", "photons"}; }

std::vector<std::string> parts() { return {"path", "recursive", "photons", "ways"}; }

bool is_wanted(const Plan& plan, std::string_view part) {
  return plan.parts.empty() || std::find(plan.parts.begin(), plan.parts.end(), part) != plan.parts.end();
}

bool is_wanted(const Plan& plan, std::string_view method, std::string_view sampler) {
  const bool served = method == "path" || std::find(std::begin(few), std::end(few), sampler) != std::end(few);
  const bool asked = plan.samplers.empty() || sampler == plan.ours || sampler == "exact" ||
                     std::find(plan.samplers.begin(), plan.samplers.end(), sampler) != plan.samplers.end();
  return served && asked;
}

std::vector<std::string> shown_samplers() { return {"cosine", "proxy", "paper", "exact", "one-shot"}; }

std::string picture_file(const Setting& setting, const std::string& sampler, bool error) {
  return std::string("pictures-") + setting.name + "-" + sampler + (error ? "-error.png" : ".png");
}

// Three digits, fixed: columns are read downwards.
std::string shown(double x) {
  char text[40];
  const double a = std::abs(x);
  const int decimals = !(a > 0) ? 2 : std::clamp(2 - int(std::floor(std::log10(a))), 0, 6);
  std::snprintf(text, sizeof text, "%.*f", decimals, x);
  return text;
}

std::string shown(const Estimate& e) {
  if (!(std::abs(e.value) > 0)) return "–";
  if (std::isnan(e.error)) return shown(e.value);
  const double a = std::abs(e.value);
  const int decimals = std::clamp(2 - int(std::floor(std::log10(a))), 0, 6);
  char text[80];
  std::snprintf(text, sizeof text, "%.*f ± %.*f", decimals, e.value, decimals, e.error);
  return text;
}

void add_scene(Page& page, const Results& results, const Plan& plan, const Setting& setting) {
  page.section(setting.words);
  if (setting.measured && data_folder().empty()) page.words("Left out: `REFLECTREE_DATA` is not set.");
  constexpr const char* words[] = {"Path tracing", "Recursive ray tracing, by `sample_n`",
                                   "Photon mapping with final gathering"};
  const auto names = methods();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Table t = table_of(results, plan, setting.name, names[i]);
    if (t.rows.empty()) continue;
    page.part(words[i]);
    page.table(t);
    const Cells ours = results.of(setting.name, names[i], plan.ours);
    std::vector<study::Bar> bars;
    for (const auto& row : t.rows) {
      const Estimate e = ratio_at_time(results.of(setting.name, names[i], row[0]), ours);
      bars.push_back({row[0], e.value, row[0] == plan.ours || row[0] == "exact"});
    }
    page.figure(study::bar_figure("relMSE at equal time", plan.ours + " = 1", bars));
  }
  std::string absent;
  for (const Absence& a : results.absences) {
    if (a.scene == setting.name)
      absent += (absent.empty() ? "Not there: " : " ") + a.sampler + ": " + a.why + ".";
  }
  if (!absent.empty()) page.words(absent);
  if (!setting.pictured || results.of(setting.name, "path", plan.ours).empty()) return;
  page.words("The converged picture; then " + std::to_string(plan.samples) +
             " samples per pixel of each by path tracing, with the map of errors: red where it is too "
             "bright, blue where too dark, full at 50 %.");
  page.pictures({{"converged", picture_file(setting, "reference", false)}});
  for (const std::string& name : shown_samplers()) {
    if (results.of(setting.name, "path", name).empty()) continue;
    page.pictures({{name, picture_file(setting, name, false)},
                   {"error of " + name, picture_file(setting, name, true)}});
  }
}

Page page_of(const Results& results, const Plan& plan) {
  const auto n = [](int x) { return std::to_string(x); };
  Page page;
  page.title = "Pictures";
  page.lead = n(plan.width) + " × " + n(plan.height) + " pixels, " + n(plan.samples) +
              " samples per pixel, " + n(plan.rounds) +
              " seeds, by every sampler at equal samples and at equal time; each method against one picture "
              "of path tracing by one-shot mode with " +
              n(plan.reference) + " samples of another seed.";
  page.command("REFLECTREE_DATA=... study_pictures FOLDER --seeds " + n(plan.rounds) + " --seed " +
               std::to_string(plan.seed));
  add_verdict(page, judge(results, methods(), plan.ours));
  for (const Setting* setting : plan.settings) add_scene(page, results, plan, *setting);
  add_ways(page, results, plan);
  page.section("How it is measured");
  const int split = std::max(1, int(std::lround(std::sqrt(double(plan.samples)))));
  for (const std::string& text :
       {std::string("relMSE: the mean over pixels and channels of (a − b)² / (b² + 0.01), less the converged "
                    "picture's own noise, which is known from its samples. After ±, the standard error over "
                    "seeds. All samplers share seeds, so that ratios, taken seed by seed, vary less than "
                    "what they are made of."),
        std::string("Without 0.1 % of the pixels: a few bright paths can fill an untrimmed mean: one that "
                    "finds a lamp by chance, or the sun by way of the floor. So ratios leave out of each "
                    "picture one pixel in a thousand, those whose errors are largest. It is a favour to "
                    "samplers whose weights vary most. Beside it stand the untrimmed mean and its median "
                    "over seeds, which a path of one seed does not move."),
        std::string("Equal time: each sampler gets as many whole samples as fit into the CPU time of ours; "
                    "what rounding leaves is settled by error × time. (*): timings, CPU time of one thread."),
        "Path tracing: lights and surfaces by the balance heuristic. Recursive ray tracing: " + n(split) +
            " camera samples, each split in " + n(split) +
            " by `sample_n` at the first surface. Photon mapping: a pass and as many light paths as pixels "
            "for each sample, one direction of final gathering; its bias, the blur of lookups, is in its "
            "errors, the same for all samplers.",
        std::string(
            "Samplers: `resampling` has no density: lights are left to its directions, and with photons so "
            "is the adjoint's side; it is shown by path tracing alone. Recursive and photons show those that "
            "stand for a family each: variants of the same differ as they do by path tracing.")})
    page.words(text);
  return page;
}

}  // namespace reflectree::pictures
