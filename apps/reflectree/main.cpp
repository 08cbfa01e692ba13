// SPDX-License-Identifier: Apache-2.0
// Dispatches to a subcommand and translates exceptions to exit codes, once.
#include <algorithm>
#include <cstdlib>
#include <new>
#include <span>

#include "commands.hpp"
#include "interrupt.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/format_table.hpp"
#include "reflectree/text/edit_distance.hpp"

namespace {

using namespace reflectree;
using namespace reflectree::cli;

std::string about() {
  std::string files;
  for (const MaterialFormat& format : material_formats())
    files += fmt::format("  {:<37} {}\n", format.example, format.name);
  return "Exact importance sampling of any reflectance function.\n"
         "\n"
         "A MATERIAL is a sum of models and files, such as\n"
         "  ggx:alpha=0.1                         a model ('reflectree list' shows them all)\n"
         "  '0.3*lambert:rho=0.5 + ggx:alpha=0.1' a weighted sum\n" +
         files + "A SAMPLER is a file that 'reflectree build' saved.\n";
}

constexpr const char* footer =
    "The options stand before or after the subcommand; 'reflectree SUBCOMMAND --help' shows its own.\n"
    "Results go to stdout, words to stderr. Exit codes: 0 success, 1 a check failed, 2 bad input or\n"
    "usage, 3 an internal fault, 130 interrupted. NO_COLOR is obeyed.";

void add_globals(CLI::App& app, Context& context) {
  app.add_flag("--json", context.json, "Results as JSON, with a schema_version");
  app.add_flag("-q,--quiet", context.quiet, "No words on stderr but errors");
  app.add_flag("-v,--verbose", context.verbose, "More words on stderr");
  app.add_option("--seed", context.seed, "Seed of all random numbers")
      ->check([](const std::string& text) { return text[0] == '-' ? "a seed is not negative" : ""; })
      ->capture_default_str()
      ->type_name("N");
  app.add_option("--threads", context.threads,
                 "Threads, at most 1024; 0: one per core. Results do not depend on it")
      ->check(CLI::Range(0, 1024).description(""))
      ->capture_default_str()
      ->type_name("N");
  app.add_option("--data", context.data,
                 "Folder where files are looked for as well; without it, REFLECTREE_DATA")
      ->type_name("FOLDER");
}

// The subcommand that is written most like `word`.
std::string nearest_subcommand(const CLI::App& app, const std::string& word) {
  const auto all = app.get_subcommands([](const CLI::App*) { return true; });
  const auto nearest = std::min_element(all.begin(), all.end(), [&](const CLI::App* a, const CLI::App* b) {
    return edit_distance(word, a->get_name()) < edit_distance(word, b->get_name());
  });
  return (*nearest)->get_name();
}

// The words of CLI11 in the form of every other error: what, where, how.
int usage_error(const CLI::App& app, const CLI::ParseError& error, std::span<char* const> words) {
  std::string where = "reflectree";
  for (const CLI::App* sub : app.get_subcommands()) where += " " + sub->get_name();
  if (app.get_subcommands().empty() && words.size() > 1 && words[1][0] != '-') {
    const std::string word = words[1];
    fmt::print(stderr, "error: reflectree: no subcommand '{}'; did you mean '{}'? see reflectree --help\n",
               word, nearest_subcommand(app, word));
    return exit_bad_input;
  }
  std::string what = error.what();
  for (char& c : what) {
    if (c == '\n') c = ' ';
  }
  fmt::print(stderr, "error: {}: {}; see {} --help\n", where, what, where);
  return exit_bad_input;
}

int dispatch(int argc, char** argv) {
  Context context;
  if (const char* data = std::getenv("REFLECTREE_DATA")) context.data = data;
  CLI::App app(about(), "reflectree");
  app.set_version_flag("--version", std::string("reflectree ") + REFLECTREE_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  add_globals(app, context);
  app.footer(footer);
  Run run;
  for (const auto add :
       {add_list, add_build, add_certify, add_info, add_eval, add_sample, add_verify, add_doctor, add_draw,
        add_bake, add_export, add_compare, add_render, add_image_compare, add_demo}) {
    add(app, context, run);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);  // --help, --version
  } catch (const CLI::ParseError& error) {
    return usage_error(app, error, {argv, std::size_t(argc)});
  }
  watch_for_interrupt();
  const int code = run();
  finish_output();
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return dispatch(argc, argv);
  } catch (const Cancelled&) {
    fmt::print(stderr, "interrupted\n");
    return exit_interrupted;
  } catch (const Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return exit_bad_input;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: memory: not enough; free some, or ask for less at once\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: internal fault: {}; please report it with the command\n", error.what());
  }
  return exit_internal;
}
