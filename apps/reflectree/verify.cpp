// SPDX-License-Identifier: Apache-2.0
// verify: every check of the verify room on one sampler; with a planted fault, to show that it is caught.
#include "commands.hpp"
#include "measure.hpp"
#include "suspects.hpp"
#include "verdicts.hpp"

namespace reflectree::cli {

namespace {

struct Options {
  std::string subject, plant = "none", theta_o_deg = "0,30,60,80,89";
  std::uint64_t samples = VerifyOptions{}.samples, trials = VerifyOptions{}.trials;
  int random_elevations = VerifyOptions{}.random_elevations, members = VerifyOptions{}.members;
  double effort = 1;
  BuildChoices choices;
};

int run_verify(const Context& context, const Options& o) {
  VerifyOptions options;
  options.theta_o_deg = parse_theta_o(o.theta_o_deg);
  options.samples = o.samples;
  options.trials = o.trials;
  options.random_elevations = o.random_elevations;
  options.effort = o.effort;
  options.seed = context.seed;
  Verdicts verdicts(context, o.plant);
  options.on_check = [&](const CheckResult& check) { verdicts.add(check); };
  options.on_figure = [&](const VerifyFigure& figure) { verdicts.add(figure); };
  if (names_family(o.subject, context.places())) {
    const OpenedFamily family = with_fault(o.plant, open_family(context, o.subject, o.choices));
    const auto judge = [&](const Parameters& at, const VerifyOptions& each, const Host& host) {
      const MemberSampler member = family.sampler.at(at);
      return verify(suspect_with_fault(family, at, member, o.plant), each, host);
    };
    options.members = o.members;
    return verdicts.finish(family.data.material,
                           verify_members(family.family.ranges(), judge, options, context.host("checking")));
  }
  const OpenedSampler subject = with_fault(o.plant, open_sampler(context, o.subject, o.choices));
  const VerifyReport report = verify(suspect_with_fault(subject, o.plant), options, context.host("checking"));
  return verdicts.finish(subject.data.material, report);
}

}  // namespace

void add_verify(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand("verify",
                                         "Check a sampler: every way into it by chi-square, weights, "
                                         "densities, albedo, bounds; exit code 1 if a "
                                         "check fails");
  auto o = std::make_shared<Options>();
  command->add_option("SAMPLER", o->subject, "A sampler file, or a material (built on the fly)")
      ->type_name("")
      ->required();
  command->add_option("--theta-o-deg", o->theta_o_deg, "Elevations of wo from the normal; any azimuth")
      ->type_name("DEG,...")
      ->capture_default_str();
  command->add_option("--random", o->random_elevations, "Further elevations, chosen by the seed")
      ->check(CLI::Range(0, 1000).description(""))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--members", o->members, "Of a family: members anywhere in its ranges, besides both ends")
      ->check(CLI::Range(0, 1000).description(""))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--samples", o->samples, "Directions for each wo and way in, at least 20000")
      ->check(CLI::Range(std::uint64_t(20'000), std::uint64_t(1'000'000'000)).description(""))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--bound-trials", o->trials,
                   "Trials in search of overshoots, at least 10000; n of them show a mass of 4/n")
      ->check(CLI::Range(std::uint64_t(10'000), std::uint64_t(10'000'000'000)).description(""))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--effort", o->effort, "Factor of all that is drawn; 0.01 to 1000")
      ->check(CLI::Range(0.01, 1000.).description(""))
      ->type_name("X")
      ->capture_default_str();
  command->add_option("--plant", o->plant, "Plant a fault, to see it caught; FAULT is one of those below")
      ->check(CLI::IsMember(fault_names()).description(""))
      ->type_name("FAULT")
      ->capture_default_str();
  add_build_choices(*command, o->choices);
  command->footer(
      "Faults: " + fault_list() +
      "\n"
      "Examples:\n"
      "  reflectree verify gold.rfl\n"
      "  reflectree verify ggx:alpha=0.1 --theta-o-deg 0,45,89 --plant bent\n"
      "Checks that hold are summed up where they are many; -v shows each. 'open' is a check that so many\n"
      "draws cannot decide: it fails nobody, and says what would.");
  command->callback([&context, &run, o] { run = [&context, o] { return run_verify(context, *o); }; });
}

}  // namespace reflectree::cli
