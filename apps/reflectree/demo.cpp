// SPDX-License-Identifier: Apache-2.0
// demo: the main job on a few materials: build, save, prove, measure, draw; a table and a page.
#include "demo.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "commands.hpp"
#include "interrupt.hpp"
#include "pictures.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/open.hpp"
#include "reflectree/formats/sampler_file.hpp"

namespace reflectree::cli {

namespace fs = std::filesystem;

namespace {

constexpr const char* built_in[] = {"lambert",       "oren_nayar",   "ggx:alpha=0.5",
                                    "ggx:alpha=0.1", "plastic",      "retro_reflector",
                                    "baked_matt",    "baked_glossy", "baked_retro"};
// From matt to metallic; those that the data folder has.
constexpr const char* measured[] = {"rgl/paper_white_rgb.bsdf", "rgl/satin_purple_rgb.bsdf",
                                    "rgl/vch_golden_yellow_rgb.bsdf", "rgl/irid_flake_paint1_rgb.bsdf",
                                    "rgl/chm_mint_rgb.bsdf"};

constexpr std::uint64_t chi_square_samples = 1'000'000;
constexpr std::uint64_t overshoot_trials = 5'000'000;
constexpr std::size_t drawn_samples = 150'000;
const std::vector<double> view_deg{15, 45, 75};
constexpr std::size_t tests_a_view = 2;

// Chi-square of both modes at every view; relative variance of one-shot mode, the worst view.
void prove(const OpenedSampler& subject, int tests, const Context& context, const Host& host,
           Outcome& outcome) {
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
    host.progress(float(verdict.tests) / float(2 * view_deg.size() + 1));
  }
  outcome.report.figures.chi_square = verdict;
  outcome.report.figures.relative_variance = variance;
}

// "ggx:alpha=0.1" -> "ggx_alpha_0.1"; "folder/paper.bsdf" -> "paper".
std::string file_name(const Material& material, const std::string& text) {
  const bool is_file = material.terms.size() == 1 && !material.terms[0].path.empty();
  std::string name = text;
  if (is_file) {
    name = fs::path(material.terms[0].path).stem().string();
    if (!material.terms[0].member.empty()) name += "_" + material.terms[0].member;
  }
  for (char& c : name) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-';
    if (!plain) c = '_';
  }
  return name.substr(0, 100);
}

std::string origin(const Material& material) {
  if (material.terms.size() != 1) return "weighted sum";
  const MaterialTerm& term = material.terms[0];
  if (term.model.empty()) return "from the file " + term.path;
  const ModelInfo* model = find_model(term.model);
  return model ? std::string(model->summary) + ". " + std::string(model->source) : "";
}

// Written, read back, and compared.
void save(const OpenedSampler& subject, const std::string& path) {
  save_sampler(path, subject.data);
  if (load_sampler(path) == subject.data) return;
  throw std::logic_error("a saved sampler reads back differently: " + path);
}

Outcome run_material(const std::string& text, int tests, const std::string& folder, const Context& context) {
  const OpenedSampler subject = open_sampler(context, text, {});
  const Material material = parse_material(subject.data.material, subject.places);
  Outcome outcome;
  outcome.text = text;
  outcome.name = file_name(material, text);
  outcome.saved = (fs::path(folder) / (outcome.name + ".rfl")).string();
  save(subject, outcome.saved);
  const Host host = context.host("proving");
  outcome.report = draw_material(subject, view_deg, drawn_samples, context.seed);
  outcome.report.name = text;
  outcome.report.origin = origin(material);
  prove(subject, tests, context, host, outcome);
  outcome.overshoot = measure_overshoot(subject, overshoot_trials, context.seed, host);
  outcome.speed = measure_speed(subject, context.seed);
  draw::ReportFigures& figures = outcome.report.figures;
  figures.overshoot_mass = outcome.overshoot.mass.estimate;
  figures.mean_trials = outcome.speed.mean_trials;
  figures.exact_ns = outcome.speed.exact_ns;
  figures.one_shot_ns = outcome.speed.one_shot_ns;
  return outcome;
}

std::vector<std::string> default_materials(const Context& context) {
  std::vector<std::string> materials(std::begin(built_in), std::end(built_in));
  std::error_code ignored;
  for (const char* path : measured) {
    if (fs::exists(context.locate(path), ignored)) materials.emplace_back(path);
  }
  if (materials.size() == std::size(built_in)) {
    context.say("No measured files: name some, or set REFLECTREE_DATA to a folder with rgl/*.bsdf");
  }
  return materials;
}

int run_demo(const Context& context, std::vector<std::string> materials, const std::string& folder) {
  if (materials.empty()) materials = default_materials(context);
  for (const std::string& text : materials) {  // a typing error shows now, not after minutes
    if (!names_sampler_file(text, context.places())) open_brdf(text, context.places());
  }
  make_folder(folder);
  const auto start = std::chrono::steady_clock::now();
  std::vector<Outcome> outcomes;
  const int tests = int(materials.size() * view_deg.size() * tests_a_view);
  for (const std::string& text : materials) {
    if (interrupted()) throw Cancelled();
    context.say(fmt::format("{}/{}  {}", outcomes.size() + 1, materials.size(), text));
    outcomes.push_back(run_material(text, tests, folder, context));
    for (const CheckResult& check : outcomes.back().checks) {
      if (context.verbose || !check.passed) context.say("  " + to_line(check));
    }
  }
  draw::ReportMeta meta;
  meta.command = "reflectree demo";
  meta.version = REFLECTREE_VERSION;
  std::vector<draw::ReportMaterial> reports;
  for (const Outcome& outcome : outcomes) reports.push_back(outcome.report);
  const std::string page = (fs::path(folder) / "index.html").string();
  write_file_atomically(page, draw::report_html(reports, meta));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  show_outcomes(context, outcomes, page, took.count());
  const bool passed =
      std::all_of(outcomes.begin(), outcomes.end(), [](const Outcome& o) { return all_passed(o.checks); });
  return passed ? exit_success : exit_check_failed;
}

}  // namespace

void add_demo(CLI::App& app, Context& context, Run& run) {
  CLI::App* command =
      app.add_subcommand("demo", "Show it all: build, save, prove, measure and draw a few materials");
  struct Options {
    std::vector<std::string> materials;
    std::string output = "reflectree-demo";
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option("MATERIAL", o->materials,
                   "Materials or files; nothing: a choice of models and, from the data folder, RGL files")
      ->type_name("");
  command->add_option("-o,--output", o->output, "The folder to write: a page, and every sampler")
      ->type_name("FOLDER")
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  reflectree demo\n"
      "  reflectree demo ggx:alpha=0.05 my_measurement.bsdf -o shown\n"
      "The table: slabs, leaves of exact + one-shot mode; trials: mean of exact mode; overshoot: the share "
      "of\n"
      "the target above its bounds with its upper 95 % bound; ns: a sample, with random numbers and "
      "evaluation;\n"
      "variance: of one-shot weights, relative, the worst of the angles drawn.");
  command->callback(
      [&context, &run, o] { run = [&context, o] { return run_demo(context, o->materials, o->output); }; });
}

}  // namespace reflectree::cli
