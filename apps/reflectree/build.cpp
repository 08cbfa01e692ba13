// SPDX-License-Identifier: Apache-2.0
// build: a material's sampler into a file.
#include <filesystem>

#include "commands.hpp"
#include "info.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "subject.hpp"

namespace reflectree::cli {

// Before minutes of work, not after.
void check_output(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    throw Error("no such folder", folder.string(), "make it, or choose another output");
  }
  if (fs::is_directory(path, ignored)) throw Error("is a folder", path, "name a file");
}

namespace {

// As above: a material whose bounds cannot be proved.
void check_provable(const Context& context, const std::string& material) {
  const FilePlaces places = context.places();
  const std::string refusal =
      names_family(material, places)
          ? no_proof(make_family(parse_material(material, places),
                                 [&](const std::string& file, const std::string& member) {
                                   return open_brdf(file_text(file, member), places);
                                 }))
          : no_proof(open_brdf(material, places));
  if (!refusal.empty()) throw Error(refusal, material, "leave out --certify; its bounds stay estimated");
}

}  // namespace

void add_build(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand("build", "Build a material's sampler and save it");
  struct Options {
    std::string material, output;
    BuildChoices choices;
    bool certify = false;
  };
  auto o = std::make_shared<Options>();
  command->add_option("MATERIAL", o->material, "A model, a sum, or a file (see reflectree --help)")
      ->type_name("")
      ->required();
  command->add_option("-o,--output", o->output, "The sampler file to write")->type_name("FILE")->required();
  add_build_choices(*command, o->choices);
  command->add_flag("--certify", o->certify, "Prove the bounds, too (see reflectree certify --help)");
  command->footer(
      "Examples:\n"
      "  reflectree build ggx:alpha=0.1 -o gold.rfl --certify\n"
      "  reflectree build paper_white.bsdf -o paper.rfl --trials 1.1\n"
      "  reflectree build ggx:alpha=0.02..1 -o metals.rfl\n"
      "A parameter with a range makes a family: one sampler of every value inside.\n"
      "The file names its material; keep a measured file beside it, or in the folder of --data.");
  command->callback([&context, &run, o] {
    run = [&context, o] {
      check_output(o->output);
      if (names_sampler_file(o->material, context.places())) {
        throw Error("is a sampler already", o->material, "name a material");
      }
      if (o->certify) check_provable(context, o->material);
      const auto save = [&](auto subject) {
        save_sampler(o->output, subject.data);
        subject.file_size = std::filesystem::file_size(o->output);
        show_info(context, "build", subject);
      };
      if (names_family(o->material, context.places())) {
        OpenedFamily family = open_family(context, o->material, o->choices);
        save(o->certify ? certified(context, std::move(family), {}) : std::move(family));
      } else if (o->certify) {
        save(certified(context, open_sampler(context, o->material, o->choices), {}));
      } else {
        save(open_sampler(context, o->material, o->choices));
      }
      context.say("saved " + o->output);
      return int(exit_success);
    };
  });
}

}  // namespace reflectree::cli
