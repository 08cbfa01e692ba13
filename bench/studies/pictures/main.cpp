// SPDX-License-Identifier: Apache-2.0
// study_pictures: the same picture by every sampler and by three integrators, at equal samples and at equal
// time, against a converged one; and exact sampling together with other ways of reducing variance. Writes
// pictures.md, pictures.html and the pictures into a folder; Ctrl-C writes them of the cells that are done.
// Exit code 1: the demand of decision 0022 does not hold.
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "../study_program.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/peers/registry.hpp"
#include "work.hpp"

namespace {

namespace fs = std::filesystem;
using namespace reflectree;
using namespace reflectree::pictures;

volatile std::sig_atomic_t interrupt_flag = 0;
extern "C" void on_interrupt(int) { interrupt_flag = 1; }

// A second Ctrl-C ends the program at once.
void watch_for_interrupt() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  action.sa_flags = int(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &action, nullptr);
}

struct Options {
  Plan plan;
  Place place;
  std::vector<std::string> only;
  bool quick = false, resume = false;
};

void declare(CLI::App& app, Options& o) {
  app.add_option("folder", o.place.folder, "Where the page and its pictures go; made if need be")->required();
  app.add_option("--only", o.only, "These scenes alone: metal, metals, retro, ball, plates")->delimiter(',');
  app.add_option("--parts", o.plan.parts, "These parts alone: path, recursive, photons, ways")
      ->delimiter(',')
      ->check(CLI::IsMember(parts()));
  app.add_option("--samplers", o.plan.samplers, "These samplers beside ours")->delimiter(',');
  app.add_option("--ours", o.plan.ours, "The sampler that the verdict is about")->capture_default_str();
  app.add_option("--seeds", o.plan.rounds, "Independent pictures of each cell")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--other-seeds", o.plan.other_rounds, "The same of recursive and photons")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--seed", o.plan.seed, "What they follow from")->capture_default_str();
  app.add_option("--reference", o.plan.reference, "Samples per pixel of the converged picture")
      ->check(CLI::Range(2, 1 << 20))
      ->capture_default_str();
  app.add_option("--threads", o.place.threads, "Cells at a time")->check(CLI::Range(1, 256));
  app.add_option("--scenes", o.place.scenes, "Folder of the scenes")->capture_default_str();
  app.add_flag("--quick", o.quick, "Small pictures of few samples: a trial, no result");
  app.add_flag("--resume", o.resume, "Go on with the cells that FOLDER/pictures-kept has");
}

void settle(Options& o) {
  Plan& p = o.plan;
  if (o.quick)
    p.width = 90, p.height = 40, p.samples = 4, p.directions = 4, p.reference = std::min(p.reference, 64);
  p.samplers.push_back(p.ours);
  for (const std::string& name : p.samplers) {
    if (!find_sampler(name)) throw Error("no sampler '" + name + "'", "--samplers", "see 'reflectree list'");
  }
  if (p.samplers.size() == 1) p.samplers.clear();
  for (const std::string& name : o.only) {
    const auto has = [&](const Setting& s) { return s.name == name; };
    if (std::none_of(settings().begin(), settings().end(), has))
      throw Error("no scene '" + name + "'", "--only", "choose of metal, metals, retro, ball and plates");
  }
  for (const Setting& s : settings()) {
    if (o.only.empty() || std::find(o.only.begin(), o.only.end(), s.name) != o.only.end())
      p.settings.push_back(&s);
  }
  o.place.host.cancelled = [] { return interrupt_flag != 0; };
}

// Exit code 1 where what the study demands does not hold; nothing to compare fails nothing.
int judged(const Options& o, const Results& results) {
  const Verdict v = judge(results, methods(), o.plan.ours);
  if (v.against.empty() || demand_holds(v)) return 0;
  std::fprintf(stderr, "the demand does not hold: see the verdict of the page\n");
  return 1;
}

void write(const Options& o, const Results& results) {
  const Page page = page_of(results, o.plan);
  write_file_atomically(o.place.folder + "/pictures.md", markdown(page));
  write_file_atomically(o.place.folder + "/pictures.html", html(page, o.place.folder));
}

int run(Options& o) {
  settle(o);
  const fs::path kept_cells = fs::path(o.place.folder) / "pictures-kept";
  std::error_code ignored;  // write() names what cannot be made
  if (!o.resume) fs::remove_all(kept_cells, ignored);
  fs::create_directories(kept_cells, ignored);
  const std::string key = key_of(o.plan);
  Results results{key, {}, {}};
  if (o.resume && fs::exists(o.place.cells())) results = kept(o.place.cells(), key);
  write(o, results);  // before the work: the folder may refuse it
  try {
    for (const Setting* setting : o.plan.settings) {
      if (setting->measured && data_folder().empty()) {
        std::fprintf(stderr, "%s: left out, REFLECTREE_DATA is not set\n", setting->name);
        continue;
      }
      study_scene(results, o.plan, o.place, *setting);
      write(o, results);
    }
  } catch (const Cancelled&) {
    write(o, results);
    std::fprintf(stderr, "interrupted; --resume goes on\n");
    return 130;
  }
  write(o, results);
  return judged(o, results);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "The study in pictures: the same scenes by every sampler. Exit code 1: its demand does not hold.");
  Options o;
  o.place.scenes = "bench/studies/scenes";
  o.place.threads = std::max(1U, std::thread::hardware_concurrency());
  declare(app, o);
  watch_for_interrupt();
  return study::run_program(app, argc, argv, [&] { return run(o); });
}
