// SPDX-License-Identifier: Apache-2.0
// verify: every check of the verify room on one sampler; with a planted fault, to show that it is caught.
#include <algorithm>

#include "commands.hpp"
#include "measure.hpp"
#include "reflectree/draw/disk_image.hpp"
#include "reflectree/verify/consistency.hpp"
#include "reflectree/verify/furnace.hpp"
#include "reflectree/verify/reciprocity.hpp"
#include "suspects.hpp"
#include "verdicts.hpp"

namespace reflectree::cli {

namespace {

constexpr int chi_square_tests = 5;  // at each wo

struct Options {
  std::string subject, plant = "none", theta_o_deg = "0,30,60,80,89";
  std::uint64_t samples = 1'000'000, trials = 10'000'000;
  BuildChoices choices;
};

// Of exact mode's albedo, which is the mean of its weights; what floats can say at least.
double stated_error(const Subject& subject) {
  return std::max(double(subject.data.albedo.relative_error), 1e-6);
}

void check_viewer(const Suspects& s, double stated, Direction wo, const ChiSquareOptions& chi,
                  const Host& host, Verdicts& verdicts) {
  const Bins bins = equal_mass_bins(s.f, wo, {}, host);
  const Tally exact = tally_of(s.exact, bins, chi, host), one_shot = tally_of(s.one_shot, bins, chi, host);
  verdicts.add(check_counts(exact, bins, chi));
  verdicts.add(check_mean_weight(exact, bins, chi, stated));
  verdicts.add(check_counts(one_shot, density_masses(s.one_shot, bins, 1e-3, host), chi));
  verdicts.add(check_weights(one_shot, bins, chi));
  verdicts.add(check_mean_weight(one_shot, bins, chi));
  ConsistencyOptions options;
  options.seed = chi.seed;
  for (const ErasedSampler* sampler : {&s.exact, &s.one_shot}) {
    std::vector<CheckResult> results = check_consistency(*sampler, s.f, wo, options, host);
    for (CheckResult& result : results) result.detail = sampler->name + ", " + result.detail;
    verdicts.add_group(sampler->name, results);
  }
  verdicts.inform("one_shot_relative_variance", relative_variance(one_shot));
}

void check_all_viewers(const Subject& subject, const Options& o, const Suspects& s, const Context& context,
                       const Host& host, Verdicts& verdicts) {
  FurnaceOptions furnace;
  furnace.seed = context.seed;
  furnace.tolerance = stated_error(subject);
  furnace.grazing_tolerance = 10 * furnace.tolerance;
  const auto table = [&](Direction wo) { return double(subject.sampler.exact.albedo(wo)); };
  verdicts.add(check_albedo_table(table, s.f, furnace, host));
  verdicts.inform("albedo_stated_error", furnace.tolerance);
  const auto once = [&](Direction wo, Pcg32& u) {
    const auto drawn = subject.sampler.exact.sample_once(wo, u);
    return drawn ? double(subject.data.target(drawn->weight)) : 0.;
  };
  verdicts.add(
      check_albedo_estimates("sample_once", once, s.f, draw::viewer_at(0.8f), o.trials, context.seed, host));
  const Overshoot overshoot = measure_overshoot(subject, o.trials, context.seed, host);
  // What n trials can show: none seen in n is a rate of 3.7 / n at 97.5 %.
  verdicts.add(check_overshoot(overshoot.mass, std::max(1e-6, 4. / double(o.trials))));
  verdicts.inform("worst_ratio_under_attack", overshoot.attack.worst);
  const PhysicsReport physics = measure_physics(s.f, 20'000, context.seed);
  verdicts.add(check_isotropy(physics, 1e-2));  // what the builder lets pass
  verdicts.inform("mean_mirror_asymmetry", physics.mirror.mean);
  verdicts.inform("mean_miss_of_reciprocity", physics.reciprocity.mean);
  verdicts.inform("largest_albedo", physics.max_albedo);
}

int run_verify(const Context& context, const Options& o) {
  const std::vector<double> theta_o_deg = parse_theta_o(o.theta_o_deg);
  const Subject subject = with_fault(o.plant, open_subject(context, o.subject, o.choices));
  const Host host = context.host("checking");
  ChiSquareOptions chi;
  chi.samples = o.samples;
  chi.seed = context.seed;
  chi.tests = int(theta_o_deg.size()) * chi_square_tests;
  Verdicts verdicts(context, o.plant);
  for (std::size_t i = 0; i < theta_o_deg.size(); ++i) {
    const Direction wo = draw::viewer_at(float(theta_o_deg[i] * pi_v<double> / 180));
    verdicts.heading(fmt::format("theta_o {} deg", theta_o_deg[i]));
    check_viewer(suspects(subject, o.plant, wo), stated_error(subject), wo, chi, host, verdicts);
    host.progress(float(i + 1) / float(theta_o_deg.size() + 1));
  }
  verdicts.heading("every theta_o");
  check_all_viewers(subject, o, suspects(subject, "none", {}), context, host, verdicts);
  return verdicts.finish(subject.data.material);
}

}  // namespace

void add_verify(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand(
      "verify",
      "Check a sampler: chi-square, weights, densities, albedo, bounds; exit code 1 if a check fails");
  auto o = std::make_shared<Options>();
  command->add_option("SAMPLER", o->subject, "A sampler file, or a material (built on the fly)")
      ->type_name("")
      ->required();
  command->add_option("--theta-o-deg", o->theta_o_deg, "Elevations of wo from the normal")
      ->type_name("DEG,...")
      ->capture_default_str();
  command->add_option("--samples", o->samples, "Directions for each wo and mode, at least 100000")
      ->check(CLI::Range(std::uint64_t(100'000), std::uint64_t(1'000'000'000)).description(""))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--bound-trials", o->trials,
                   "Trials in search of overshoots, at least 10000; n of them show a mass of 4/n")
      ->check(CLI::Range(std::uint64_t(10'000), std::uint64_t(10'000'000'000)).description(""))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--plant", o->plant, "Plant a fault, to see it caught; FAULT is one of those below")
      ->check(CLI::IsMember(fault_names()).description(""))
      ->type_name("FAULT")
      ->capture_default_str();
  add_build_choices(*command, o->choices);
  command->footer("Faults: " + fault_list() +
                  "\n"
                  "Examples:\n"
                  "  reflectree verify gold.rfl\n"
                  "  reflectree verify ggx:alpha=0.1 --theta-o-deg 0,45,89 --plant bent\n"
                  "Checks that hold are summed up where they are many; -v shows each.");
  command->callback([&context, &run, o] { run = [&context, o] { return run_verify(context, *o); }; });
}

}  // namespace reflectree::cli
