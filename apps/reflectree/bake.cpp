// SPDX-License-Identifier: Apache-2.0
// bake: any isotropic material as a MERL .binary file.
#include "commands.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/merl.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "subject.hpp"

namespace reflectree::cli {

namespace {

int run_bake(const Context& context, const std::string& text, const std::string& output, bool whole) {
  const FilePlaces places = context.places();
  if (names_sampler_file(text, places)) {
    throw Error("is a sampler; a bake needs a material", text,
                "name " + load_sampler(places.find(text)).material);
  }
  const AnyBrdf f = open_brdf(text, places);
  const HalfAngleTable table = tabulate_merl(f, !whole, context.host("baking"));
  const Bytes bytes = write_merl(table);
  write_file_atomically(output, ByteView(bytes));
  if (context.json) {
    context.print_json("bake", {{"material", f.traits().name},
                                {"output", output},
                                {"bytes", bytes.size()},
                                {"cells", {table.n_h, table.n_d, table.n_p}}});
  } else {
    context.print(fmt::format("{}  {}x{}x{} cells, {:.1f} MiB\n", output, table.n_h, table.n_d, table.n_p,
                              double(bytes.size()) / (1 << 20)));
  }
  return exit_success;
}

}  // namespace

void add_bake(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand("bake", "Tabulate any isotropic material as a MERL .binary file");
  struct Options {
    std::string material, output;
    bool whole = false;
  };
  auto o = std::make_shared<Options>();
  command->add_option("MATERIAL", o->material, "A model, a sum, or a file (see reflectree --help)")
      ->type_name("")
      ->required();
  command->add_option("-o,--output", o->output, "The MERL file to write")->type_name("FILE")->required();
  command->add_flag("--non-reciprocal", o->whole,
                    "360 cells of phi_d, for materials with f(wo, wi) != f(wi, wo); few readers know it");
  command->footer(
      "Example:\n"
      "  reflectree bake plastic:alpha=0.2 -o plastic.binary");
  command->callback([&context, &run, o] {
    run = [&context, o] { return run_bake(context, o->material, o->output, o->whole); };
  });
}

}  // namespace reflectree::cli
