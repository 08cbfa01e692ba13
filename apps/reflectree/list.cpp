// SPDX-License-Identifier: Apache-2.0
// list: the models; or a material's canonical text; or what a file holds.
#include "commands.hpp"
#include "reflectree/brdf/material/registry.hpp"
#include "reflectree/formats/format_table.hpp"
#include "reflectree/text/number_text.hpp"
#include "subject.hpp"

namespace reflectree::cli {

namespace {

std::string value_text(const ParameterInfo& p) {
  std::string text = shortest_text(p.initial.r);
  const bool grey = p.initial.r == p.initial.g && p.initial.g == p.initial.b;
  if (p.channels == 3 && !grey) text += "/" + shortest_text(p.initial.g) + "/" + shortest_text(p.initial.b);
  return text;
}

Json json_of(const ModelInfo& model) {
  Json parameters = Json::array();
  for (const ParameterInfo& p : model.parameters) {
    Json initial = shortest(p.initial.r);
    if (p.channels == 3) initial = {shortest(p.initial.r), shortest(p.initial.g), shortest(p.initial.b)};
    parameters.push_back({{"name", p.name},
                          {"channels", p.channels},
                          {"minimum", shortest(p.lo)},
                          {"maximum", shortest(p.hi)},
                          {"default", initial},
                          {"unit", p.unit},
                          {"meaning", p.meaning}});
  }
  return {{"name", model.name},
          {"class", name_of(model.model_class)},
          {"summary", model.summary},
          {"source", model.source},
          {"parameters", parameters}};
}

int list_models(const Context& context) {
  if (context.json) {
    Json all = Json::array();
    for (const ModelInfo& model : models()) all.push_back(json_of(model));
    context.print_json("list", {{"models", all}});
    return exit_success;
  }
  for (const ModelInfo& model : models()) {
    context.print(fmt::format("{}  ({}) {}. {}.\n", model.name, name_of(model.model_class), model.summary,
                              model.source));
    for (const ParameterInfo& p : model.parameters) {
      context.print(fmt::format("    {:<10} {:<18} {} to {}{}{}\n", p.name,
                                value_text(p) + (p.channels == 3 ? " (rgb)" : ""), shortest_text(p.lo),
                                shortest_text(p.hi), p.unit.empty() ? "" : " " + std::string(p.unit),
                                p.meaning.empty() ? "" : "  " + std::string(p.meaning)));
    }
  }
  context.say(
      "Each line: parameter, default, range, meaning. Write MODEL:NAME=VALUE,...; sums with weights: "
      "0.3*lambert + ggx:alpha=0.1");
  return exit_success;
}

// A file that a text names as a whole, and what may follow its '#'.
struct ListedFile {
  std::string path;
  FileMembers kind = FileMembers::none;
  std::vector<std::string> names;
};
ListedFile listed_file(const Material& material, const FilePlaces& places) {
  const MaterialTerm& term = material.terms[0];
  if (material.terms.size() > 1 || term.path.empty() || !term.member.empty()) return {};
  const Bytes bytes = read_material_file(term.path, places);
  const MaterialFormat& format = format_of(bytes, term.path);
  if (!format.list_members) return {term.path, format.members, {}};
  return {term.path, format.members, format.list_members(bytes, term.path)};
}

int list_materials(const Context& context, const ListedFile& file) {
  std::vector<std::string> whole;
  for (const std::string& name : file.names) whole.push_back(file_text(file.path, name));
  if (context.json) {
    context.print_json("list", {{"members", whole}});
  } else {
    for (const std::string& text : whole) context.print(text + "\n");
  }
  return exit_success;
}

int list_one(const Context& context, const std::string& text) {
  const FilePlaces places = context.places();
  ListedFile file;
  if (!names_sampler_file(text, places)) file = listed_file(parse_material(text, places), places);
  if (file.kind == FileMembers::materials) return list_materials(context, file);  // is none itself
  const AnyBrdf f = open_brdf(text, places);
  if (context.json) {
    context.print_json("list",
                       {{"material", f.traits().name}, {"channels", f.channels()}, {"members", file.names}});
    return exit_success;
  }
  context.print(f.traits().name + "\n");
  for (const std::string& name : file.names) context.say("look-up: " + file_text(file.path, name));
  return exit_success;
}

}  // namespace

void add_list(CLI::App& app, Context& context, Run& run) {
  CLI::App* command =
      app.add_subcommand("list", "Show the models; a material in canonical form; the members of a file");
  auto text = std::make_shared<std::string>();
  command->add_option("MATERIAL", *text, "A material, a file, or a sampler; nothing: all models")
      ->type_name("");
  command->footer(
      "Examples:\n"
      "  reflectree list                     every model with its parameters\n"
      "  reflectree list ggx:alpha=0.1       that material, every parameter written out\n"
      "  reflectree list table.csv           the members of a file");
  command->callback([&context, &run, text] {
    run = [&context, text] { return text->empty() ? list_models(context) : list_one(context, *text); };
  });
}

}  // namespace reflectree::cli
