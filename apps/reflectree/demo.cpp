// SPDX-License-Identifier: Apache-2.0
// demo: the main job on a few materials: build, prove, measure, draw; a table and a page.
#include <chrono>
#include <filesystem>
#include <span>

#include "commands.hpp"
#include "interrupt.hpp"
#include "measure.hpp"
#include "pictures.hpp"
#include "reflectree/error.hpp"
#include "reflectree/io/file.hpp"
#include "reflectree/io/sampler_file.hpp"
#include "table.hpp"

namespace reflectree::cli {

namespace fs = std::filesystem;

namespace {

constexpr const char* built_in[] = {"lambert",       "oren_nayar",   "ggx:alpha=0.5",
                                    "ggx:alpha=0.1", "plastic",      "retro_reflector",
                                    "baked_matt",    "baked_glossy", "baked_retro"};
// From matt to metallic, where REFLECTREE_DATA has them.
constexpr const char* measured[] = {"rgl/paper_white_rgb.bsdf", "rgl/satin_purple_rgb.bsdf",
                                    "rgl/vch_golden_yellow_rgb.bsdf", "rgl/irid_flake_paint1_rgb.bsdf",
                                    "rgl/chm_mint_rgb.bsdf"};

constexpr std::uint64_t chi_square_samples = 1'000'000;
constexpr std::uint64_t overshoot_trials = 2'000'000;
constexpr std::size_t drawn_samples = 150'000;
const std::vector<double> view_deg{15, 45, 75};

struct Outcome {
  std::string name;
  draw::ReportMaterial report;
  Overshoot overshoot;
  std::vector<CheckResult> checks;
};

// chi-square of both modes at every view; the relative variance of one-shot mode, the worst view.
void prove(const Subject& subject, int tests, const Context& context, const Host& host, Outcome& outcome) {
  ChiSquareOptions options;
  options.samples = chi_square_samples;
  options.seed = context.seed;
  options.tests = tests;
  const TargetFunction f = target_function(subject.f, subject.data.target);
  const ErasedSampler exact = erase(subject.sampler.exact, subject.data.target, "exact");
  const ErasedSampler one_shot = erase(subject.sampler.one_shot, subject.data.target, "one-shot");
  draw::ChiSquareVerdict verdict{true, 0, 1};
  double variance = 0;
  for (const double theta : view_deg) {
    const Bins bins = equal_mass_bins(f, draw::viewer_at(float(theta * pi_v<double> / 180)), {}, host);
    const Tally drawn = tally_of(exact, bins, options, host), shot = tally_of(one_shot, bins, options, host);
    variance = std::max(variance, relative_variance(shot));
    for (CheckResult check : {check_counts(drawn, bins, options), check_weights(shot, bins, options)}) {
      check.detail += fmt::format(", theta_o {} deg", theta);
      verdict.passed = verdict.passed && check.passed;
      verdict.smallest_p = std::min(verdict.smallest_p, check.p_value);
      ++verdict.tests;
      outcome.checks.push_back(std::move(check));
    }
  }
  outcome.report.figures.chi_square = verdict;
  outcome.report.figures.relative_variance = variance;
}

Outcome run_material(const std::string& text, int tests, const std::string& folder, const Context& context) {
  const Subject subject = open_subject(context, text, {});
  const Host host = context.host("proving");
  Outcome outcome;
  outcome.name = text;
  outcome.report = draw_material(subject, view_deg, drawn_samples, context.seed);
  draw::ReportFigures& figures = outcome.report.figures;
  prove(subject, tests, context, host, outcome);
  outcome.overshoot = measure_overshoot(subject, overshoot_trials, context.seed, host);
  figures.overshoot_mass = outcome.overshoot.mass.estimate;
  const Speed speed = measure_speed(subject, context.seed);
  figures.mean_trials = speed.mean_trials;
  figures.exact_ns = speed.exact_ns, figures.one_shot_ns = speed.one_shot_ns;
  (void)folder;
  return outcome;
}

Table table_of(const std::vector<Outcome>& outcomes) {
  Table table{{"material", "domain", "slabs", "leaves", "KiB", "build s", "trials", "chi-square", "overshoot",
               "(at most)", "exact ns", "one-shot ns", "rel. variance"},
              {}};
  for (const Outcome& o : outcomes) {
    const draw::ReportFigures& f = o.report.figures;
    table.rows.push_back(
        {o.name, f.domain, fmt::format("{}+{}", f.exact_slabs, f.one_shot_slabs),
         fmt::format("{}+{}", f.exact_leaves, f.one_shot_leaves), fmt::format("{:.0f}", f.kib.value_or(0)),
         f.build_seconds ? fmt::format("{:.2f}", *f.build_seconds) : "-",
         fmt::format("{:.3f}", *f.mean_trials), f.chi_square->passed ? "pass" : "FAIL",
         fmt::format("{:.1g}", o.overshoot.mass.estimate), fmt::format("{:.1g}", o.overshoot.mass.upper),
         fmt::format("{:.0f}", *f.exact_ns), fmt::format("{:.0f}", *f.one_shot_ns),
         fmt::format("{:.4f}", *f.relative_variance)});
  }
  return table;
}

int run_demo(const Context& context, std::vector<std::string> materials, const std::string& folder) {
  if (materials.empty()) {
    materials.assign(std::begin(built_in), std::end(built_in));
    for (const char* path : measured) {
      if (context.locate(path) != path || fs::exists(path)) materials.emplace_back(path);
    }
  }
  make_folder(folder);
  std::vector<Outcome> outcomes;
  const int tests = int(materials.size() * view_deg.size() * 2);
  for (const std::string& text : materials) {
    if (interrupted()) throw Cancelled();
    context.say(fmt::format("{}/{}  {}", outcomes.size() + 1, materials.size(), text));
    const auto start = std::chrono::steady_clock::now();
    outcomes.push_back(run_material(text, tests, folder, context));
    context.detail(fmt::format(
        "  {:.1f} s", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()));
    for (const CheckResult& c : outcomes.back().checks) context.detail("  " + to_line(c));
  }
  draw::ReportMeta meta;
  meta.command = "reflectree demo";
  meta.version = REFLECTREE_VERSION;
  const std::string page = (fs::path(folder) / "index.html").string();
  std::vector<draw::ReportMaterial> reports;
  for (Outcome& o : outcomes) reports.push_back(o.report);
  write_file_atomically(page, draw::report_html(reports, meta));
  context.print(coloured_verdicts(to_text(table_of(outcomes))));
  context.print(page + "\n");
  return exit_success;
}

}  // namespace

void add_demo(CLI::App& app, Context& context, Run& run) {
  CLI::App* command =
      app.add_subcommand("demo", "Show it all: build, prove, measure and draw a few materials");
  struct Options {
    std::vector<std::string> materials;
    std::string output = "reflectree-demo";
  };
  auto o = std::make_shared<Options>();
  command->add_option("MATERIAL", o->materials,
                      "Materials or files; nothing: the built-in choice, and RGL files of the data folder");
  command->add_option("-o,--output", o->output, "The folder to write")
      ->type_name("FOLDER")
      ->capture_default_str();
  command->callback(
      [&context, &run, o] { run = [&context, o] { return run_demo(context, o->materials, o->output); }; });
}

}  // namespace reflectree::cli
