// SPDX-License-Identifier: Apache-2.0
// export: a sampler as an array in the text of a programming language, for the runtimes of one file.
#include "commands.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "reflectree_load.h"
#include "subject.hpp"

namespace reflectree::cli {

namespace {

struct ExportOptions {
  std::string subject, c, glsl, wgsl, name = "rfl_words";
  BuildChoices choices;
};

// The array of words of runtime/reflectree_sample.h, made by its own loader.
std::vector<std::uint32_t> words_of(const OpenedSampler& subject) {
  const Bytes bytes = encode_sampler(subject.data);
  rfl_sampler s;
  if (const char* error = rfl_load_bytes(&s, bytes.data(), bytes.size())) {
    throw Error(error, subject.text, "name a sampler or a material of one function");
  }
  std::vector<std::uint32_t> words(s.words, s.words + s.words[2]);
  rfl_free(&s);
  return words;
}

// What a comment of one line can hold.
std::string in_a_comment(std::string text) {
  for (char& c : text) {
    if (std::uint8_t(c) < 0x20 || std::uint8_t(c) >= 0x7f || c == '\\') c = '?';
  }
  for (std::size_t at = text.find("*/"); at != std::string::npos; at = text.find("*/")) text[at + 1] = '?';
  return text;
}

std::string joined(const std::vector<std::uint32_t>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += fmt::format("{}{:#x}u", i == 0 ? "" : i % 10 == 0 ? ",\n" : ",", words[i]);
  return text;
}

// `before` and `after` the words; {n} is their number, {name} the array's.
struct Language {
  std::string path, before, after;
};

bool is_identifier(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  if (name.empty() || name.size() > 60 || !letter(name[0])) return false;
  return std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || (c >= '0' && c <= '9'); });
}

int run_export(const Context& context, const ExportOptions& o) {
  if (!is_identifier(o.name)) throw Error("is no name of an array", o.name, "use letters, digits and _");
  if (o.c.empty() && o.glsl.empty() && o.wgsl.empty())
    throw Error("no language is chosen", "export", "give --c, --glsl or --wgsl with a file");
  const OpenedSampler subject = open_sampler(context, o.subject, o.choices);
  const std::vector<std::uint32_t> words = words_of(subject);
  const std::string n = std::to_string(words.size()), body = joined(words);
  const std::string about =
      "Written by reflectree export: the sampler of " + in_a_comment(subject.data.material);
  const Language languages[] = {
      {o.c,
       "/* " + about + ".\n * rfl_open(&s, " + o.name + ", " + n +
           ") of reflectree_sample.h makes it a sampler. */\n#include <stdint.h>\nstatic const uint32_t " +
           o.name + "[" + n + "] = {\n",
       "};\n"},
      {o.glsl,
       "// " + about + ".\n// For reflectree_sample.glsl.\nconst uint " + o.name + "[" + n + "] = uint[" + n +
           "](\n",
       ");\n#define RFL_WORD(i) " + o.name + "[i]\n"},
      {o.wgsl, "// " + about + ".\nconst " + o.name + " = array<u32, " + n + ">(\n", ");\n"}};
  Json files = Json::array();
  for (const Language& language : languages) {
    if (language.path.empty()) continue;
    const std::string text = language.before + body + language.after;
    write_file_atomically(language.path, text);
    files.push_back(language.path);
    if (!context.json)
      context.print(
          fmt::format("{}  {} words, {:.1f} KiB\n", language.path, words.size(), double(words.size()) / 256));
  }
  if (context.json) {
    context.print_json("export",
                       {{"material", subject.data.material}, {"words", words.size()}, {"files", files}});
  }
  return exit_success;
}

}  // namespace

void add_export(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand(
      "export", "Write a sampler as an array in C, GLSL or WGSL, for runtimes of one file");
  auto o = std::make_shared<ExportOptions>();
  command->add_option("SAMPLER", o->subject, "A sampler file, or a material (built on the fly)")
      ->type_name("")
      ->required();
  command->add_option("--c", o->c, "C text, for runtime/reflectree_sample.h")->type_name("FILE");
  command->add_option("--glsl", o->glsl, "GLSL text, for runtime/reflectree_sample.glsl")->type_name("FILE");
  command->add_option("--wgsl", o->wgsl, "WGSL text: the array alone")->type_name("FILE");
  command->add_option("--name", o->name, "The name of the array")->type_name("WORD")->capture_default_str();
  add_build_choices(*command, o->choices);
  command->footer(
      "Examples:\n"
      "  reflectree export gold.rfl --c gold.h --name gold\n"
      "  reflectree export ggx:alpha=0.2 --glsl gold.glsl");
  command->callback([&context, &run, o] { run = [&context, o] { return run_export(context, *o); }; });
}

}  // namespace reflectree::cli
