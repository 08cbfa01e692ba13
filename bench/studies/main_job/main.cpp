// SPDX-License-Identifier: Apache-2.0
// Measures what was promised of the main job on every material, and prints a page of Markdown. Seeds are
// fixed; --resume keeps each material's results in a folder, so that a run can be continued.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "../threads.hpp"
#include "anisotropic_page.hpp"
#include "promises.hpp"
#include "reflectree/formats/file.hpp"

namespace {

using namespace reflectree;
using namespace reflectree::study;

std::string file_name(const std::string& material) {
  std::string name = material;
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return name + ".json";
}

int run(int argc, char** argv) {
  CLI::App app{"The main job, measured on every material"};
  const char* folder = std::getenv("REFLECTREE_DATA");
  std::string data = folder ? folder : "", only, markdown, json, resume;
  bool reduced = false, list = false, untimed = false, rebuild = false, kept_only = false;
  int threads = 2;
  StudyOptions options;
  app.add_option("--data", data, "folder of the measured materials (default: REFLECTREE_DATA)");
  app.add_option("--only", only, "only materials whose name contains this");
  app.add_option("--markdown", markdown, "write the page to this file");
  app.add_option("--json", json, "write all measurements to this file");
  app.add_option("--resume", resume, "folder that keeps each material's results");
  app.add_option("--threads", threads)->check(CLI::Range(1, 256));
  app.add_option("--samples", options.samples, "of each chi-square test");
  app.add_option("--overshoot-trials", options.overshoot_trials, "per material");
  app.add_option("--albedo-directions", options.albedo_directions, "random theta_o, per material");
  app.add_option("--albedo-trials", options.albedo_trials, "per material");
  app.add_flag("--anisotropic", options.anisotropic, "anisotropic materials, each at 30 random viewers");
  app.add_flag("--reduced", reduced, "a dozen models, fewer samples: a few minutes");
  app.add_flag("--untimed", untimed, "do not judge build times (other work is running)");
  app.add_flag("--rebuild", rebuild,
               "with --resume: time the builds of kept materials anew, on a quiet machine");
  app.add_flag("--kept", kept_only, "with --resume: print what is kept, measure nothing new");
  app.add_flag("--list", list, "list the materials");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  if (options.anisotropic) {
    options.angles_deg = {89};
    options.random_angles = 30;
    options.albedo_directions = 60;
    options.albedo_trials = 1'000'000;
    options.overshoot_trials = std::min<std::uint64_t>(options.overshoot_trials, 10'000'000);
    options.probed_wo = 2000;
  }
  if (reduced) {
    options.samples = 200'000;
    options.angles_deg = {0, 45, 85};
    options.random_angles = 1;
    options.albedo_directions = 30;
    options.albedo_trials = 1'000'000;
    options.overshoot_trials = 2'000'000;
  }
  if (data.empty() && !reduced) {
    std::cerr << "no measured materials: neither --data nor REFLECTREE_DATA names their folder\n";
  }
  const auto materials = options.anisotropic ? anisotropic_materials(data) : study_materials(data, reduced);
  // The level of a test is that of the whole list, whichever part of it is run.
  options.tests = int(materials.size()) * tests_of_material(options);
  const Host host = host_with_threads(threads);
  std::vector<Measurement> all;
  for (const StudyMaterial& material : materials) {
    if (material.name.find(only) == std::string::npos) continue;
    if (list) {
      std::cout << material.name << '\n';
      continue;
    }
    const std::string kept = resume.empty() ? "" : resume + "/" + file_name(material.name);
    if (!kept.empty() && std::filesystem::exists(kept)) {
      all.push_back(nlohmann::json::parse(std::ifstream(kept)).get<Measurement>());
      if (rebuild) {
        time_build(load(material, data), host, all.back());
        std::fprintf(stderr, "[%zu] %s: build %.2f s\n", all.size(), material.name.c_str(),
                     all.back().build_seconds);
        write_file_atomically(kept, nlohmann::json(all.back()).dump(1));
      }
      continue;
    }
    if (kept_only) {
      std::fprintf(stderr, "%s: not measured\n", material.name.c_str());
      continue;
    }
    const Measurement m = measure(material, load(material, data), options, host);
    int failed = 0;
    for (const Verdict& v : m.verdicts) {
      if (v.passed) continue;
      ++failed;
      std::cerr << material.name << ": " << v.line << '\n';
    }
    std::fprintf(stderr, "[%zu] %s: build %.2f s, %.0f KiB, %d failed, attack %.4f, overshoot %.1e;",
                 all.size() + 1, m.material.c_str(), m.build_seconds, m.kib, failed, m.attack_ratio,
                 m.overshoot_upper);
    for (const double s : m.part_seconds) std::fprintf(stderr, " %.1f", s);
    std::fprintf(stderr, " s\n");
    if (!kept.empty()) {
      std::filesystem::create_directories(resume);
      write_file_atomically(kept, nlohmann::json(m).dump(1));
    }
    all.push_back(m);
  }
  if (list) return 0;
  std::string command = "study_main_job";
  if (options.anisotropic) {
    const std::string page = anisotropic_page(all, options, command + " --anisotropic");
    std::cout << page;
    if (!markdown.empty()) write_file_atomically(markdown, page);
    if (!json.empty()) write_file_atomically(json, nlohmann::json(all).dump(1));
    return !all.empty() && std::all_of(all.begin(), all.end(),
                                       [&](const Measurement& m) { return misses_of(m, options).empty(); })
               ? 0
               : 1;
  }
  const auto promises = judge(all, options, !untimed);
  if (reduced) command += " --reduced";
  if (!only.empty()) command += " --only '" + only + "'";
  const std::string page = to_markdown(all, promises, options, command);
  std::cout << page;
  if (!markdown.empty()) write_file_atomically(markdown, page);
  if (!json.empty()) write_file_atomically(json, nlohmann::json(all).dump(1));
  bool kept = !all.empty();
  for (const Promise& p : promises) kept = kept && p.kept;
  return kept ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 2;
  }
}
