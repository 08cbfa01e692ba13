// SPDX-License-Identifier: Apache-2.0
// sample: directions for one wo, as CSV or .npy.
#include "commands.hpp"
#include "interrupt.hpp"
#include "measure.hpp"
#include "reflectree/error.hpp"
#include "rows.hpp"
#include "subject.hpp"

namespace reflectree::cli {

namespace {

struct Options {
  std::string subject, mode = "exact", output, at;
  double theta_o_deg = 45, phi_o_deg = 0;
  std::uint64_t count = 1000;
  BuildChoices choices;
};

struct Samples {
  Rows rows;
  std::uint64_t none = 0;  // "no sample"
};

template <class Draw>
Samples draw_samples(const OpenedSampler& subject, Direction wo, const Options& o, std::uint64_t seed,
                     const Draw& draw) {
  Samples samples;
  samples.rows.columns = {"wi_x", "wi_y", "wi_z", "pdf"};
  const int channels = subject.f.channels();
  for (int c = 0; c < channels; ++c) samples.rows.columns.push_back(channel_name("weight", c, channels));
  std::vector<float>& values = samples.rows.values;
  Pcg32 u(seed);
  for (std::uint64_t i = 0; i < o.count; ++i) {
    if (i % 4096 == 0 && interrupted()) throw Cancelled();
    const auto s = draw(wo, u);
    if (!s) {
      ++samples.none;
      continue;
    }
    values.insert(values.end(), {s->wi.x, s->wi.y, s->wi.z, s->pdf});
    for (int c = 0; c < channels; ++c) values.push_back(channel_value(s->weight, c));
  }
  return samples;
}

int run_sample(const Context& context, const Options& o) {
  if (!(o.theta_o_deg >= 0 && o.theta_o_deg < 90)) {
    throw Error(fmt::format("{} is not above the surface", o.theta_o_deg), "--theta-o-deg",
                "give degrees from 0 to below 90");
  }
  const OpenedSampler subject = open_sampler(context, o.subject, o.choices, o.at);
  const double degree = pi_v<double> / 180;
  const Direction wo = direction_from_angles(float(o.theta_o_deg * degree), float(o.phi_o_deg * degree));
  const Sampler<AnyBrdf>& s = subject.sampler;
  const Samples samples = o.mode == "exact"
                              ? draw_samples(subject, wo, o, context.seed,
                                             [&](Direction w, Pcg32& u) { return s.exact.sample(w, u); })
                              : draw_samples(subject, wo, o, context.seed,
                                             [&](Direction w, Pcg32& u) { return s.one_shot.sample(w, u); });
  const Json json{
      {"material", subject.data.material}, {"mode", o.mode},       {"theta_o_deg", o.theta_o_deg},
      {"phi_o_deg", o.phi_o_deg},          {"seed", context.seed}, {"samples", samples.rows.count()},
      {"no_sample", samples.none}};
  put_out(context, "sample", json, samples.rows, o.output);
  if (samples.none) context.say(fmt::format("{} of {} draws were \"no sample\"", samples.none, o.count));
  if (!o.output.empty()) context.say(fmt::format("saved {} ({} rows)", o.output, samples.rows.count()));
  return exit_success;
}

}  // namespace

void add_sample(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand(
      "sample", "Draw directions: columns wi_x, wi_y, wi_z, pdf (per solid angle), weight (f cos / pdf)");
  auto o = std::make_shared<Options>();
  command->add_option("SAMPLER", o->subject, "A sampler file, or a material (built on the fly)")
      ->type_name("")
      ->required();
  command->add_option("--theta-o-deg", o->theta_o_deg, "Elevation of wo from the normal, below 90")
      ->capture_default_str()
      ->type_name("DEG");
  command->add_option("--phi-o-deg", o->phi_o_deg, "Azimuth of wo")
      ->check(CLI::Range(-360., 360.).description(""))
      ->capture_default_str()
      ->type_name("DEG");
  command->add_option("-n,--count", o->count, "How many directions, at most 10000000")
      ->check(CLI::Range(std::uint64_t(1), std::uint64_t(10'000'000)).description(""))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--mode", o->mode, "exact (rejection) or one-shot (no rejection)")
      ->check(CLI::IsMember({"exact", "one-shot"}).description(""))
      ->capture_default_str()
      ->type_name("MODE");
  command
      ->add_option("-o,--output", o->output, "A .npy file, or a CSV file of any other name; default: stdout")
      ->type_name("FILE");
  add_member_choice(*command, o->at);
  add_build_choices(*command, o->choices);
  command->footer(
      "Examples:\n"
      "  reflectree sample gold.rfl --theta-o-deg 60 -n 1000 > points.csv\n"
      "  reflectree sample ggx:alpha=0.1 --mode one-shot -n 100000 -o points.npy\n"
      "Both directions point away from the surface; z is the normal; wo has azimuth --phi-o-deg.");
  command->callback([&context, &run, o] { run = [&context, o] { return run_sample(context, *o); }; });
}

}  // namespace reflectree::cli
