// SPDX-License-Identifier: Apache-2.0
// sample: directions for one wo, as CSV or .npy.
#include "commands.hpp"
#include "interrupt.hpp"
#include "measure.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/npy.hpp"
#include "reflectree/text/number_text.hpp"
#include "subject.hpp"

namespace reflectree::cli {

namespace {

struct Options {
  std::string subject, mode = "exact", output;
  double theta_o_deg = 45, phi_o_deg = 0;
  std::uint64_t count = 1000;
  BuildChoices choices;
};

struct Samples {
  std::size_t columns = 0;    // wi_x wi_y wi_z pdf weight...
  std::vector<float> values;  // row after row
  std::size_t rows() const { return values.size() / columns; }
  std::uint64_t none = 0;  // "no sample"
};

template <class Draw>
Samples draw_samples(const OpenedSampler& subject, Direction wo, const Options& o, std::uint64_t seed,
                     const Draw& draw) {
  Samples samples;
  samples.columns = 4 + std::size_t(subject.f.channels());
  Pcg32 u(seed);
  for (std::uint64_t i = 0; i < o.count; ++i) {
    if (i % 4096 == 0 && interrupted()) throw Cancelled();
    const auto s = draw(wo, u);
    if (!s) {
      ++samples.none;
      continue;
    }
    samples.values.insert(samples.values.end(), {s->wi.x, s->wi.y, s->wi.z, s->pdf});
    for (int c = 0; c < subject.f.channels(); ++c) samples.values.push_back(channel_value(s->weight, c));
  }
  return samples;
}

std::vector<std::string> column_names(int channels) {
  std::vector<std::string> names{"wi_x", "wi_y", "wi_z", "pdf"};
  for (int c = 0; c < channels; ++c) {
    names.push_back("weight_" + (channels == 3 ? std::string(1, "rgb"[c]) : std::to_string(c)));
  }
  return names;
}

std::string csv(const Samples& samples, const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  text += '\n';
  for (std::size_t i = 0; i < samples.values.size(); ++i) {
    text += shortest_text(samples.values[i]);
    text += (i + 1) % samples.columns ? ',' : '\n';
  }
  return text;
}

int run_sample(const Context& context, const Options& o) {
  if (!(o.theta_o_deg >= 0 && o.theta_o_deg < 90)) {
    throw Error(fmt::format("{} is not above the surface", o.theta_o_deg), "--theta-o-deg",
                "give degrees from 0 to below 90");
  }
  const OpenedSampler subject = open_sampler(context, o.subject, o.choices);
  const double degree = pi_v<double> / 180;
  const Direction wo = direction_from_angles(float(o.theta_o_deg * degree), float(o.phi_o_deg * degree));
  const Sampler<AnyBrdf>& s = subject.sampler;
  const Samples samples = o.mode == "exact"
                              ? draw_samples(subject, wo, o, context.seed,
                                             [&](Direction w, Pcg32& u) { return s.exact.sample(w, u); })
                              : draw_samples(subject, wo, o, context.seed,
                                             [&](Direction w, Pcg32& u) { return s.one_shot.sample(w, u); });
  const std::vector<std::string> names = column_names(subject.f.channels());
  if (o.output.ends_with(".npy")) {
    const std::size_t shape[] = {samples.rows(), samples.columns};
    write_file_atomically(o.output, ByteView(encode_npy(samples.values, shape)));
  } else if (!o.output.empty()) {
    write_file_atomically(o.output, csv(samples, names));
  } else if (!context.json) {
    context.print(csv(samples, names));
  }
  if (context.json) {
    Json json{{"material", subject.data.material}, {"mode", o.mode},       {"theta_o_deg", o.theta_o_deg},
              {"phi_o_deg", o.phi_o_deg},          {"seed", context.seed}, {"samples", samples.rows()},
              {"no_sample", samples.none},         {"columns", names}};
    if (o.output.empty()) {
      json["rows"] = Json::array();
      for (std::size_t i = 0; i < samples.rows(); ++i) {
        const auto row = samples.values.begin() + std::ptrdiff_t(i * samples.columns);
        Json numbers = Json::array();
        for (std::size_t k = 0; k < samples.columns; ++k) numbers.push_back(shortest(row[std::ptrdiff_t(k)]));
        json["rows"].push_back(std::move(numbers));
      }
    } else {
      json["output"] = o.output;
    }
    context.print_json("sample", json);
  }
  if (samples.none) context.say(fmt::format("{} of {} draws were \"no sample\"", samples.none, o.count));
  if (!o.output.empty()) context.say(fmt::format("saved {} ({} rows)", o.output, samples.rows()));
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
  add_build_choices(*command, o->choices);
  command->footer(
      "Examples:\n"
      "  reflectree sample gold.rfl --theta-o-deg 60 -n 1000 > points.csv\n"
      "  reflectree sample ggx:alpha=0.1 --mode one-shot -n 100000 -o points.npy\n"
      "Both directions point away from the surface; z is the normal; wo has azimuth --phi-o-deg.");
  command->callback([&context, &run, o] { run = [&context, o] { return run_sample(context, *o); }; });
}

}  // namespace reflectree::cli
