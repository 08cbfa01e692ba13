// SPDX-License-Identifier: Apache-2.0
// bake: any isotropic material as a MERL .binary file, any material at all as an RGL .bsdf file.
#include "commands.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/merl.hpp"
#include "reflectree/formats/rgl_fit.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "subject.hpp"

namespace reflectree::cli {

namespace {

struct BakeOptions {
  std::string material, output, format = "merl";
  bool whole = false;
  RglFitOptions rgl;
};

double mebibytes(const Bytes& bytes) { return double(bytes.size()) / (1 << 20); }

int bake_merl(const Context& context, const BakeOptions& o, const AnyBrdf& f) {
  const HalfAngleTable table = tabulate_merl(f, !o.whole, context.host("baking"));
  const Bytes bytes = write_merl(table);
  write_file_atomically(o.output, ByteView(bytes));
  if (context.json) {
    context.print_json("bake", {{"material", f.traits().name},
                                {"output", o.output},
                                {"bytes", bytes.size()},
                                {"cells", {table.n_h, table.n_d, table.n_p}}});
  } else {
    context.print(fmt::format("{}  {}x{}x{} cells, {:.1f} MiB\n", o.output, table.n_h, table.n_d, table.n_p,
                              mebibytes(bytes)));
  }
  return exit_success;
}

int bake_rgl(const Context& context, const BakeOptions& o, const AnyBrdf& f) {
  const RglFit fit = fit_rgl(f, o.rgl, context.host("baking"));
  const RglWideFields& fields = fit.fields;
  const Bytes bytes = write_rgl(fit, f.traits().name);
  write_file_atomically(o.output, ByteView(bytes));
  const double error = rgl_fit_error(RglWideTable(fields), f);
  if (context.json) {
    context.print_json("bake", {{"material", f.traits().name},
                                {"output", o.output},
                                {"bytes", bytes.size()},
                                {"azimuths", fields.phi_o.size()},
                                {"elevations", fields.theta_o.size()},
                                {"reduction", fields.reduction},
                                {"normals", fields.warp_width},
                                {"colours", fields.colour_width},
                                {"error", error}});
  } else {
    const std::string kind = fields.phi_o.size() == 1 ? "isotropic"
                             : fields.reduction == 4  ? "anisotropic, mirrored in two planes"
                             : fields.reduction == 2  ? "anisotropic, half a turn alike"
                                                      : "anisotropic, without symmetry";
    context.print(fmt::format("{}  {}, {} x {} viewers, {:.1f} MiB; differs from the material by {:.2g} %\n",
                              o.output, kind, fields.phi_o.size(), fields.theta_o.size(), mebibytes(bytes),
                              100 * error));
  }
  return exit_success;
}

int run_bake(const Context& context, const BakeOptions& o) {
  const FilePlaces places = context.places();
  if (names_sampler_file(o.material, places)) {
    throw Error("is a sampler; a bake needs a material", o.material,
                "name " + load_sampler(places.find(o.material)).material);
  }
  const AnyBrdf f = open_brdf(o.material, places);
  return o.format == "rgl" ? bake_rgl(context, o, f) : bake_merl(context, o, f);
}

}  // namespace

void add_bake(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand("bake", "Tabulate any material as a MERL or an RGL file");
  auto o = std::make_shared<BakeOptions>();
  command->add_option("MATERIAL", o->material, "A model, a sum, or a file (see reflectree --help)")
      ->type_name("")
      ->required();
  command->add_option("-o,--output", o->output, "The file to write")->type_name("FILE")->required();
  command
      ->add_option("--format", o->format,
                   "merl: a .binary of isotropic cells; rgl: a .bsdf, isotropic or not")
      ->check(CLI::IsMember({"merl", "rgl"}))
      ->type_name("FORMAT")
      ->capture_default_str();
  command->add_flag(
      "--non-reciprocal", o->whole,
      "merl: 360 cells of phi_d, for materials with f(wo, wi) != f(wi, wo); few readers know it");
  const auto size = [&](const char* name, int& value, int most, const char* help) {
    command->add_option(name, value, help)->check(CLI::Range(2, most))->type_name("N")->capture_default_str();
  };
  size("--elevations", o->rgl.elevations, 256, "rgl: viewers from the normal to the horizon");
  size("--azimuths", o->rgl.azimuths, 256, "rgl: viewers in a quarter of a turn, for anisotropic materials");
  size("--normals", o->rgl.normals, 512, "rgl: nodes a side of the tables of normals");
  size("--colours", o->rgl.colours, 256, "rgl: nodes a side of the tables of colours");
  command->footer(
      "Examples:\n"
      "  reflectree bake plastic:alpha=0.2 -o plastic.binary\n"
      "  reflectree bake ggx:alpha_x=0.05,alpha_y=0.3 --format rgl -o brushed.bsdf");
  command->callback([&context, &run, o] { run = [&context, o] { return run_bake(context, *o); }; });
}

}  // namespace reflectree::cli
