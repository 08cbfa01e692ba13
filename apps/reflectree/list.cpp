// SPDX-License-Identifier: Apache-2.0
// list: the models; or a material's canonical text; or what a file holds.
#include <filesystem>

#include "commands.hpp"
#include "reflectree/text/number_text.hpp"
#include "reflectree/brdf/material/registry.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/sampler_file.hpp"
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

int list_one(const Context& context, const std::string& text) {
  const bool is_sampler = names_sampler_file(context, text);
  const std::string words = is_sampler ? load_sampler(context.locate(text)).material : text;
  const Material material = parse(context, words, is_sampler ? context.locate(text) : "");
  std::vector<std::string> members;
  const bool is_file =
      material.terms.size() == 1 && !material.terms[0].path.empty() && material.terms[0].member.empty();
  if (is_file && !is_sampler) members = list_members(context.locate(material.terms[0].path));
  // A table of many materials is none itself.
  if (members.size() > 2 || (members.size() > 0 && members[0] != "nearest")) {
    std::vector<std::string> whole;
    for (const std::string& member : members) {
      whole.push_back(to_text(Material{{{1, "", {}, material.terms[0].path, member}}}));
    }
    if (context.json) {
      context.print_json("list", {{"members", whole}});
    } else {
      for (const std::string& member : whole) context.print(member + "\n");
    }
    return exit_success;
  }
  const AnyBrdf f = load_material(context, material, is_sampler ? context.locate(text) : "");
  if (context.json) {
    context.print_json("list",
                       {{"material", f.traits().name}, {"channels", f.channels()}, {"members", members}});
    return exit_success;
  }
  context.print(f.traits().name + "\n");
  for (const std::string& member : members) {
    context.say("look-up: " + to_text(Material{{{1, "", {}, material.terms[0].path, member}}}));
  }
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
