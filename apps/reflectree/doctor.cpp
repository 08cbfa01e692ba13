// SPDX-License-Identifier: Apache-2.0
// doctor: judges eval, sample and pdf of anybody's sampler and says in words what is wrong: ours and peers by
// name, or a program on a pipe.
#include "reflectree/formats/open.hpp"
#include "reflectree/verify/doctor.hpp"

#include <cmath>

#include "commands.hpp"
#include "interrupt.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/peers/registry.hpp"
#include "reflectree/study/doctor_page.hpp"
#include "reflectree/verify/program_patient.hpp"

namespace reflectree::cli {

namespace {

struct Options {
  std::string subject, sampler = "exact", program, effort = "default", html, eval = "", values = "";
  double timeout = 60;
};

const std::map<std::string, DoctorEffort> efforts{
    {"quick", DoctorEffort::quick}, {"default", DoctorEffort::normal}, {"thorough", DoctorEffort::thorough}};
const std::map<std::string, EvalKind> eval_kinds{
    {"detect", EvalKind::detect}, {"f", EvalKind::f}, {"f_cos", EvalKind::f_cos}};
const std::map<std::string, ValueKind> value_kinds{{"detect", ValueKind::detect},
                                                   {"weight", ValueKind::weight},
                                                   {"f_cos", ValueKind::f_cos},
                                                   {"f", ValueKind::f},
                                                   {"none", ValueKind::none}};

template <class T>
std::vector<std::string> keys(const std::map<std::string, T>& table) {
  std::vector<std::string> names;
  for (const auto& [name, value] : table) names.push_back(name);
  return names;
}

std::string sampler_names() {
  std::string names;
  for (const SamplerInfo& info : samplers()) {
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  return names;
}

// In lines of the help's width.
std::string wrapped_names() {
  std::string text;
  std::size_t line = 0;
  for (const SamplerInfo& info : samplers()) {
    line += info.name.size() + 2;
    text += (text.empty() ? "" : line > 90 ? ",\n  " : ", ") + std::string(info.name);
    if (line > 90) line = info.name.size();
  }
  return text;
}

PeerSubject subject_of(const Context& context, const std::string& text) {
  const FilePlaces places = context.places();
  if (names_sampler_file(text, places)) {
    const OpenedSampler opened = open_sampler_file(text, places);
    return {opened.f, {}, opened.data.target, opened.packed};
  }
  const Material material = parse_material(text, places);
  return {make_brdf(material, places), material, {}, nullptr};
}

AnySampler<Spectrum> make_sampler_named(const std::string& name, const PeerSubject& subject,
                                        const std::string& text, const Host& host) {
  const SamplerInfo* info = find_sampler(name);
  if (!info) throw Error("no sampler '" + name + "'", "--sampler", "choose of " + sampler_names());
  auto made = info->make(subject, host);
  if (!made)
    throw Error("the sampler '" + name + "' does not serve this material", text,
                "choose another of " + sampler_names());
  return std::move(*made);
}

// What our one-shot mode does with the same function, for comparison.
std::vector<VerifyFigure> ours_beside(const PeerSubject& subject, std::span<const DoctorView> views,
                                      const Host& host) {
  std::vector<VerifyFigure> figures;
  const AnySampler<Spectrum> ours = *find_sampler("one-shot")->make(subject, host);
  for (const DoctorView& view : views) {
    Pcg32 u(17);
    double sum = 0, sum2 = 0;
    constexpr int n = 20'000;
    for (int i = 0; i < n; ++i) {
      const auto s = ours.sample(view.wo, u);
      const double w = s ? double(subject.target(s->weight)) : 0;
      sum += w, sum2 += w * w;
    }
    const double theta = double(theta_of(view.wo)) * 180 / pi_v<double>;
    if (sum > 0)
      figures.push_back({"our_one_shot_relative_variance", fmt::format("theta_o {:.4g} deg", theta),
                         n * sum2 / (sum * sum) - 1});
  }
  return figures;
}

Json json_of(Direction w) { return {shortest(w.x), shortest(w.y), shortest(w.z)}; }
// JSON has no NaN.
Json json_of(double x) { return std::isfinite(x) ? Json(x) : Json(x != x ? "nan" : x > 0 ? "inf" : "-inf"); }
Json json_of(const VerifyFigure& f) {
  return {{"name", f.name}, {"where", f.where}, {"value", json_of(f.value)}};
}

Json json_of(const Diagnosis& d) {
  Json findings = Json::array(), checks = Json::array(), figures = Json::array();
  for (const Finding& f : d.findings) {
    Json item{{"check", f.check}, {"cause", f.cause}, {"words", f.words}, {"fault", f.fault}};
    item["figures"] = Json::array();
    for (const VerifyFigure& x : f.figures) item["figures"].push_back(json_of(x));
    if (f.evidence.wo != Direction{}) {
      item["evidence"] = {{"wo", json_of(f.evidence.wo)}, {"wi", json_of(f.evidence.wi)}};
      if (!f.evidence.quantity.empty()) {
        item["evidence"].update({{"quantity", f.evidence.quantity},
                                 {"found", json_of(f.evidence.found)},
                                 {"expected", json_of(f.evidence.expected)}});
      }
    }
    findings.push_back(std::move(item));
  }
  for (const CheckResult& c : d.checks) {
    checks.push_back({{"name", c.name},
                      {"where", c.where},
                      {"passed", c.passed},
                      {"statistic", json_of(c.statistic)},
                      {"threshold", json_of(c.threshold)},
                      {"p_value", json_of(c.p_value)},
                      {"detail", c.detail}});
  }
  for (const VerifyFigure& f : d.figures) figures.push_back(json_of(f));
  return {{"subject", d.subject}, {"healthy", d.healthy()}, {"conventions", d.conventions},
          {"findings", findings}, {"checks", checks},       {"figures", figures}};
}

void show(const Context& context, const Diagnosis& d) {
  std::string out = d.subject + "\n";
  for (const std::string& c : d.conventions) out += "  " + c + "\n";
  int failed = 0;
  for (const CheckResult& c : d.checks) {
    failed += !c.passed;
    if (!c.passed || context.verbose)
      out += "  " + to_line(c) + (c.where.empty() ? "" : "  at " + c.where) + "\n";
  }
  if (!context.verbose)
    out += fmt::format("  pass  {} of {} checks\n", d.checks.size() - std::size_t(failed), d.checks.size());
  for (const VerifyFigure& f : d.figures)
    out += fmt::format("        {:<30} {:<20} {:.4g}\n", f.name, f.where, f.value);
  for (const Finding& f : d.findings) out += to_text(f);
  int faults = 0;
  for (const Finding& f : d.findings) faults += f.fault;
  out += d.healthy() ? "pass  no fault was found\n"
                     : fmt::format("FAIL  {} {} found\n", faults, faults == 1 ? "fault was" : "faults were");
  context.print(coloured_verdicts(out));
}

int run_doctor(const Context& context, const Options& o) {
  if (o.subject.empty() == o.program.empty()) {
    throw Error("one subject is wanted", "doctor", "name a material or a sampler, or a program with --exec");
  }
  DoctorOptions options = doctor_options(efforts.at(o.effort));
  options.seed = context.seed;
  const Host host = context.host("examining");
  std::optional<PeerSubject> subject;
  Patient p;
  std::string command = "reflectree doctor --effort " + o.effort;
  if (!o.program.empty()) {
    ProgramOptions program;
    program.seconds = o.timeout;
    program.cancelled = interrupted;
    p = program_patient(o.program, program);
    command += " --exec '" + o.program + "'";
  } else {
    subject = subject_of(context, o.subject);
    p = patient(subject->f, make_sampler_named(o.sampler, *subject, o.subject, host));
    p.name = o.sampler + " of " + o.subject;
    command += " '" + o.subject + "' --sampler " + o.sampler;
  }
  if (!o.eval.empty()) p.eval_kind = eval_kinds.at(o.eval);
  if (!o.values.empty()) p.value_kind = value_kinds.at(o.values);
  Diagnosis d = doctor(p, options, host);
  if (subject && o.sampler != "exact" && !o.sampler.starts_with("one-shot")) {
    for (VerifyFigure& f : ours_beside(*subject, d.views, host)) d.figures.push_back(std::move(f));
  }
  if (!o.html.empty())
    write_file_atomically(o.html, study::doctor_html(d, {command, REFLECTREE_VERSION, "", ""}));
  if (context.json) {
    context.print_json("doctor", json_of(d));
  } else {
    show(context, d);
  }
  if (!o.html.empty()) context.say("saved " + o.html);
  return d.healthy() ? exit_success : exit_check_failed;
}

}  // namespace

void add_doctor(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand(
      "doctor",
      "Judge anybody's eval, sample and pdf, and say in words what is wrong; exit code 1 on a finding");
  auto o = std::make_shared<Options>();
  command->add_option("SUBJECT", o->subject, "A material, or a sampler file")->type_name("");
  command->add_option("--sampler", o->sampler, "Which sampler of it: ours or a competitor")
      ->type_name("NAME")
      ->capture_default_str();
  command->add_option("--exec", o->program, "A program that answers on a pipe, instead of a subject")
      ->type_name("'PROGRAM ARGS'");
  command
      ->add_option("--effort", o->effort, "quick, default or thorough: seconds, some ten, a minute and more")
      ->check(CLI::IsMember(keys(efforts)).description(""))
      ->type_name("WORD")
      ->capture_default_str();
  command
      ->add_option("--eval", o->eval, "What eval returns: f, f_cos or detect; nothing: as the subject says")
      ->check(CLI::IsMember(keys(eval_kinds)).description(""))
      ->type_name("KIND");
  command->add_option("--values", o->values, "What sample returns: weight, f_cos, f, none or detect")
      ->check(CLI::IsMember(keys(value_kinds)).description(""))
      ->type_name("KIND");
  command->add_option("--timeout", o->timeout, "Seconds that an answer of the program may take")
      ->check(CLI::Range(0.1, 86'400.).description(""))
      ->type_name("SECONDS")
      ->capture_default_str();
  command->add_option("--html", o->html, "Write an offline page to this file")->type_name("FILE");
  command->footer(
      "Examples:\n"
      "  reflectree doctor ggx:alpha=0.1 --sampler proxy\n"
      "  reflectree doctor --exec 'python3 examples/doctor/client.py' --html report.html\n"
      "Samplers: " +
      wrapped_names() +
      ".\n"
      "docs/doctor.md describes the checks, the protocol and how a report is read.");
  command->callback([&context, &run, o] { run = [&context, o] { return run_doctor(context, *o); }; });
}

}  // namespace reflectree::cli
