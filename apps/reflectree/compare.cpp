// SPDX-License-Identifier: Apache-2.0
// compare: every sampler on every material; a table, a verdict, and on demand CSV and a page.
#include "compare.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <mutex>

#include "commands.hpp"
#include "measure.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/format_table.hpp"
#include "reflectree/formats/open_brdf.hpp"
#include "reflectree/text/joined_words.hpp"

namespace reflectree::cli {

namespace fs = std::filesystem;
using namespace study;

namespace {

std::string first_value(const char* path, const std::string& key) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(key, 0) == 0) return line.substr(std::min(line.find(':') + 2, line.size()));
  }
  return "";
}

std::string machine() {
  utsname name{};
  uname(&name);
  std::string text = first_value("/proc/cpuinfo", "model name");
  if (text.empty()) text = name.machine;
  return text + ", " + name.sysname + " " + name.release + ", g++ " + __VERSION__;
}

// FNV-1a: two materials never share a file, whatever their names.
std::string kept_name(const std::string& material) {
  std::uint64_t hash = 14695981039346656037ULL;
  std::string name;
  for (const char c : material) {
    hash = (hash ^ std::uint8_t(c)) * 1099511628211ULL;
    name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  }
  return fmt::format("{}-{:08x}.json", name.substr(0, 80), std::uint32_t(hash ^ (hash >> 32U)));
}

// Which of the settings differ, in words.
std::string differences(const Json& kept, const Json& wanted) {
  std::string names;
  for (const auto& [name, value] : wanted.items()) {
    if (kept.is_object() && kept.contains(name) && kept[name] == value) continue;
    names += (names.empty() ? "" : ", ") + name;
  }
  return names;
}

// Results of another commit, machine or setting never stand beside ours in one table.
MaterialResult taken_up(const std::string& path, const Json& key) {
  Json kept;
  try {
    kept = Json::parse(std::ifstream(path));
    if (kept.at("made_by") == key) return material_from(kept.at("result"));
  } catch (const Json::exception&) {
    throw Error("this is no result of compare", path, "remove it, or name another folder");
  }
  const std::string others = differences(kept["made_by"], key);
  throw Error("the results kept there differ in " + (others.empty() ? "their settings" : others), path,
              "name another folder, remove this one to measure again, or repeat the settings");
}

std::string command_of(const CompareOptions& given) {
  std::string command = "reflectree compare";
  for (const std::string& m : given.materials) command += " '" + m + "'";
  if (given.quick) command += " --quick";
  if (!given.samplers.empty()) command += " --samplers " + given.samplers;
  if (!given.theta_o_deg.empty()) command += " --theta-o-deg " + given.theta_o_deg;
  for (const std::string& e : given.envmaps) command += " --envmap '" + e + "'";
  return command;
}

int run_compare(const Context& context, const CompareOptions& given) {
  StudyOptions o = given.quick ? quick_study() : StudyOptions{};
  o.seed = context.seed;
  if (!given.theta_o_deg.empty()) o.theta_o_deg = parse_theta_o(given.theta_o_deg);
  const std::vector<const SamplerInfo*> wanted = chosen_samplers(given.samplers);
  // Everything is read before the long work begins.
  std::vector<StudyMaterial> materials;
  for (const std::string& name : material_names(context, given)) {
    const FilePlaces places = context.places();
    const Material material = parse_material(name, places);
    materials.push_back({name, material, make_brdf(material, places)});
  }
  const std::vector<Illumination> lights = read_lights(context, given);
  const std::string command = command_of(given), host_machine = machine();
  const Json options = key_of(o, lights, wanted);
  Json key = options;  // what kept results must agree in
  key["commit"] = source_commit(), key["version"] = REFLECTREE_VERSION, key["machine"] = host_machine;
  if (!given.resume.empty()) {
    std::error_code ignored;
    fs::create_directories(given.resume, ignored);
    if (!fs::is_directory(given.resume))
      throw Error("this is no folder", given.resume, "name another with --resume");
  }
  const Host host = context.host("comparing");
  std::vector<std::optional<MaterialResult>> found(materials.size());
  std::vector<std::string> kept(materials.size());
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (given.resume.empty()) continue;
    kept[i] = (fs::path(given.resume) / kept_name(materials[i].name)).string();
    if (fs::exists(kept[i])) found[i] = taken_up(kept[i], key);
  }
  std::atomic<std::size_t> done{0};
  host.parallel_for(materials.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!found[i]) {
        found[i] = measure(materials[i], wanted, lights, o, host);
        const Json whole{{"made_by", key}, {"result", json_of(*found[i])}};
        if (!kept[i].empty())
          write_file_atomically(kept[i], whole.dump(1, ' ', false, Json::error_handler_t::replace));
      }
      host.progress(float(++done) / float(materials.size()));
    }
  });
  std::vector<MaterialResult> all;
  for (auto& m : found) all.push_back(std::move(*m));
  const Verdict verdict = judge(all, samplers(), lights, o);
  const StudyMeta meta{command, REFLECTREE_VERSION, host_machine, source_commit()};
  if (!given.csv.empty()) write_file_atomically(given.csv, csv_of(all, lights, o));
  if (!given.html.empty()) write_file_atomically(given.html, study_html(all, verdict, lights, o, meta));
  if (context.json) {
    Json json = Json::array();
    for (const MaterialResult& m : all) json.push_back(json_of(m));
    context.print_json("compare", {{"version", meta.version},
                                   {"commit", meta.commit},
                                   {"machine", meta.machine},
                                   {"options", options},
                                   {"materials", json},
                                   {"verdict", json_of(verdict)}});
  } else {
    show(context, all, verdict, lights, o);
  }
  return exit_success;
}

}  // namespace

void add_compare(CLI::App& app, Context& context, Run& run) {
  CLI::App* command =
      app.add_subcommand("compare", "Measure every sampler on materials, and say who is best");
  auto o = std::make_shared<CompareOptions>();
  command
      ->add_option("MATERIAL", o->materials,
                   "Materials, files, or folders of " + joined_words(material_endings(), " and ") +
                       " files; nothing: the measured ones of the data folder, or models")
      ->type_name("");
  command->add_option("--samplers", o->samplers, "Only these, with commas; nothing: all")
      ->type_name("NAME,...");
  command->add_option("--theta-o-deg", o->theta_o_deg, "Elevations of wo; nothing: 10,45,75,85")
      ->type_name("DEG,...");
  command->add_option("--envmap", o->envmaps, "Equirectangular lights; nothing: the data folder's envmaps/")
      ->type_name("FILE");
  command->add_flag("--quick", o->quick, "Fewer materials and samples: minutes");
  command->add_option("--csv", o->csv, "Write every cell to this file")->type_name("FILE");
  command->add_option("--html", o->html, "Write an offline page to this file")->type_name("FILE");
  command->add_option("--resume", o->resume, "Keep each material's results there, and take up what is there")
      ->type_name("FOLDER");
  command->footer(
      "Examples:\n"
      "  reflectree compare --quick --html compared.html\n"
      "  reflectree compare ggx:alpha=0.1 my.bsdf --samplers exact,one-shot --csv cells.csv\n"
      "variance, sum, worst: relative, of the weight, for the target, the channel sum, the worst channel; "
      "bias:\n"
      "against cubature, '!' where it is one; floor: a polar cosine-hemisphere sample; eff: 1 / (RMSE^2 "
      "seconds)\n"
      "of the reflected radiance under a light, averaged over rotations, RMSE relative to mean light x "
      "albedo,\nof one sample, with what 1024 samples in a mean make of a bias beyond its interval.");
  command->callback([&context, &run, o] { run = [&context, o] { return run_compare(context, *o); }; });
}

}  // namespace reflectree::cli
