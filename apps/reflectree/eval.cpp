// SPDX-License-Identifier: Apache-2.0
// eval: the values of a material and the densities of its sampler at given pairs, as CSV or .npy.
#include <optional>

#include "commands.hpp"
#include "eval_pairs.hpp"
#include "interrupt.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "rows.hpp"
#include "subject.hpp"

namespace reflectree::cli {

namespace {

struct Options {
  std::string subject, output, at;
  PairWords pairs;
  bool no_pdf = false;
  BuildChoices choices;
};

// `sampler`: nullptr where the densities are not asked for.
Rows evaluate(const AnyBrdf& f, const Sampler<AnyBrdf>* sampler, const DirectionPairs& pairs) {
  const int channels = f.channels();
  Rows rows;
  rows.columns = {"wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"};
  for (const char* stem : {"f", "f_cos"}) {
    for (int c = 0; c < channels; ++c) rows.columns.push_back(channel_name(stem, c, channels));
  }
  if (sampler) rows.columns.insert(rows.columns.end(), {"pdf_exact", "pdf_one_shot"});
  constexpr std::size_t block = 4096;
  std::vector<float> values(block * std::size_t(channels));
  for (std::size_t first = 0; first < pairs.wo.size(); first += block) {
    if (interrupted()) throw Cancelled();
    const std::size_t count = std::min(block, pairs.wo.size() - first);
    const auto wo = std::span(pairs.wo).subspan(first, count), wi = std::span(pairs.wi).subspan(first, count);
    const auto out = std::span(values).first(count * std::size_t(channels));
    f.eval(wo, wi, out);
    for (std::size_t i = 0; i < count; ++i) {
      rows.values.insert(rows.values.end(), {wo[i].x, wo[i].y, wo[i].z, wi[i].x, wi[i].y, wi[i].z});
      const auto of_pair = out.subspan(i * std::size_t(channels), std::size_t(channels));
      rows.values.insert(rows.values.end(), of_pair.begin(), of_pair.end());
      for (const float v : of_pair) rows.values.push_back(v * wi[i].z);
      if (!sampler) continue;
      rows.values.push_back(sampler->exact.pdf(wo[i], wi[i]));
      rows.values.push_back(sampler->one_shot.pdf(wo[i], wi[i]));
    }
  }
  return rows;
}

int run_eval(const Context& context, const Options& o) {
  const DirectionPairs pairs = read_pairs(o.pairs);  // before a build of minutes
  std::string material;
  Rows rows;
  if (o.no_pdf) {
    if (o.choices.given) throw Error("options of building do not apply", "--no-pdf", "leave them out");
    if (!o.at.empty())
      throw Error("densities of a member come from its family's sampler", "--at",
                  "leave out --no-pdf, or write the number into the material");
    const AnyBrdf f = open_brdf(o.subject, context.places());
    material = f.traits().name;
    rows = evaluate(f, nullptr, pairs);
  } else {
    const OpenedSampler subject = open_sampler(context, o.subject, o.choices, o.at);
    material = subject.data.material;
    rows = evaluate(subject.f, &subject.sampler, pairs);
  }
  rows.doubles = true;
  put_out(context, "eval", {{"material", material}, {"pairs", pairs.wo.size()}}, rows, o.output);
  if (!o.output.empty()) context.say(fmt::format("saved {} ({} rows)", o.output, rows.count()));
  return exit_success;
}

}  // namespace

void add_eval(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand(
      "eval", "Evaluate pairs: columns wo, wi, f (sr^-1, without cosine), f_cos, pdf of both modes");
  auto o = std::make_shared<Options>();
  command->add_option("SAMPLER", o->subject, "A sampler file, or a material (built on the fly)")
      ->type_name("")
      ->required();
  const auto option = [&](const char* name, auto& value, const char* type, const char* words) {
    return command->add_option(name, value, words)->type_name(type)->allow_extra_args(false);
  };
  option("--wo", o->pairs.wo, "X,Y,Z", "The known direction, a unit vector; may be given again and again")
      ->take_all();
  option("--wi", o->pairs.wi, "X,Y,Z", "The sampled direction; as many as --wo, or one for all")->take_all();
  option("--theta-o-deg", o->pairs.theta_o_deg, "DEG,...", "Elevations of wo from the normal, below 90");
  option("--theta-i-deg", o->pairs.theta_i_deg, "DEG,...", "Elevations of wi, as many, or one for all");
  option("--phi-deg", o->pairs.phi_deg, "DEG,...",
         "Azimuths of wi, that of wo being 0: 180 is the mirror side");
  option("--pairs", o->pairs.table, "FILE", "A CSV file of pairs, or - for stdin");
  command->add_flag("--no-pdf", o->no_pdf, "f and f_cos alone: nothing is built");
  command
      ->add_option("-o,--output", o->output,
                   "A .npy file (float64), or a CSV file of any other name; default: stdout")
      ->type_name("FILE");
  add_member_choice(*command, o->at);
  add_build_choices(*command, o->choices);
  command->footer(
      "Examples:\n"
      "  reflectree eval ggx:alpha=0.1 --wo 0,0,1 --wi 0.6,0,0.8\n"
      "  reflectree eval gold.rfl --theta-o-deg 60 --theta-i-deg 50,60,70 --phi-deg 180\n"
      "  reflectree eval paper_white.bsdf --no-pdf --pairs pairs.csv -o values.npy\n"
      "Both directions point away from the surface; z is the normal; densities are per solid angle.\n"
      "A CSV file of pairs has six numbers per line, wo and wi; or a header that names wo_x ... wi_z, or\n"
      "theta_o_deg, theta_i_deg and phi_deg, in any order; further columns are left aside.");
  command->callback([&context, &run, o] { run = [&context, o] { return run_eval(context, *o); }; });
}

}  // namespace reflectree::cli
