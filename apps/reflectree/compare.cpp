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
#include "reflectree/io/file.hpp"
#include "reflectree/io/image.hpp"
#include "reflectree/io/material_file.hpp"
#include "table.hpp"

namespace reflectree::cli {

namespace fs = std::filesystem;
using namespace study;

namespace {

// Of --quick, and where there is no measured file.
constexpr const char* built_in[] = {"lambert",       "oren_nayar",     "phong",         "ward:alpha=0.1",
                                    "cook_torrance", "ggx:alpha=0.5",  "ggx:alpha=0.1", "ggx:alpha=0.02",
                                    "plastic",       "retro_reflector"};

struct Options {
  std::vector<std::string> materials;
  std::string samplers, theta_o_deg, csv, html, resume;
  std::vector<std::string> envmaps;
  bool quick = false;
};

std::vector<std::string> default_materials(const Context& context, bool quick) {
  std::error_code ignored;
  const fs::path rgl = context.locate("rgl"), networks = context.locate("nbrdf/nbrdf_merl.csv");
  std::vector<std::string> measured;
  if (fs::is_directory(rgl, ignored)) {
    for (const auto& entry : fs::directory_iterator(rgl)) {
      if (entry.path().extension() == ".bsdf") measured.push_back("rgl/" + entry.path().filename().string());
    }
    std::sort(measured.begin(), measured.end());
  }
  if (fs::exists(networks, ignored)) {
    for (const std::string& m : list_members(networks.string()))
      measured.push_back("nbrdf/nbrdf_merl.csv#" + m);
  }
  if (!quick && !measured.empty()) return measured;
  if (measured.empty()) context.say("No measured files: name some, or set REFLECTREE_DATA");
  std::vector<std::string> all(std::begin(built_in), std::end(built_in));
  if (quick) all = {"lambert", "ggx:alpha=0.1", "plastic", "retro_reflector"};
  for (std::size_t i = 0; i < measured.size(); i += 15) all.push_back(measured[i]);
  return all;
}

std::vector<const SamplerInfo*> chosen(const std::string& list) {
  std::vector<const SamplerInfo*> all;
  std::string names;
  for (const SamplerInfo& info : samplers()) names += (names.empty() ? "" : ", ") + std::string(info.name);
  for (std::size_t from = 0; !list.empty() && from <= list.size();) {
    const std::size_t to = std::min(list.find(',', from), list.size());
    const std::string name = list.substr(from, to - from);
    const SamplerInfo* info = find_sampler(name);
    if (!info) throw Error("no sampler '" + name + "'", "--samplers", "choose of " + names);
    if (std::find(all.begin(), all.end(), info) == all.end()) all.push_back(info);
    from = to + 1;
  }
  if (list.empty()) {
    for (const SamplerInfo& info : samplers()) all.push_back(&info);
  }
  return all;
}

// Row 0 of the picture is the zenith; luminance by ITU-R BT.709.
Environment read_environment(const std::string& path) {
  const Image image = read_image(path);
  const int r = image.find("R"), g = image.find("G"), b = image.find("B");
  if (r < 0 || g < 0 || b < 0) throw Error("no channels R, G, B", path, "give a picture in colour");
  LatLong map{image.width, image.height, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float* pixel = image.values.data() + image.index(x, y);
      map.radiance.push_back(0.2126f * pixel[r] + 0.7152f * pixel[g] + 0.0722f * pixel[b]);
    }
  }
  return make_environment(fs::path(path).stem().string(), std::move(map));
}

// The procedural ones; then those named, or those of the data folder.
std::vector<Environment> read_lights(const Context& context, const Options& given) {
  std::vector<Environment> lights = procedural_environments();
  std::vector<std::string> paths;
  for (const std::string& path : given.envmaps) paths.push_back(context.locate(path));
  const fs::path folder = context.locate("envmaps");
  std::error_code ignored;
  if (paths.empty() && !given.quick && fs::is_directory(folder, ignored)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".hdr") paths.push_back(entry.path().string());
    }
    std::sort(paths.begin(), paths.end());
  }
  for (const std::string& path : paths) lights.push_back(read_environment(path));
  return lights;
}

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

MaterialResult taken_up(const std::string& path, const Json& key) {
  try {
    const Json kept = Json::parse(std::ifstream(path));
    if (kept.at("options") == key) return material_from(kept.at("result"));
  } catch (const Json::exception&) {
    throw Error("this is no result of compare", path, "remove it, or name another folder");
  }
  throw Error("the results kept there are of other options", path,
              "name another folder, or repeat the options");
}

void show(const Context& context, const std::vector<MaterialResult>& all, const Verdict& v,
          std::span<const Environment> lights, const StudyOptions& o) {
  for (const MaterialResult& m : all) {
    Table table{{m.material, "theta_o", "variance", "sum", "worst", "dead %", "bias", "+-", "ns", "x floor",
                 "pdf ns", "KiB", "build s"},
                {}};
    for (const Environment& light : lights) table.head.push_back("eff " + light.name);
    for (const SamplerResult& s : m.samplers) {
      if (!s.fault.empty()) table.rows.push_back({s.sampler, "fault"});
      for (std::size_t i = 0; i < s.cells.size(); ++i) {
        const study::Cell& c = s.cells[i];
        table.rows.push_back(
            {s.sampler, fmt::format("{}", o.theta_o_deg[i]), fmt::format("{:.3g}", c.target_variance),
             fmt::format("{:.3g}", c.sum_variance), fmt::format("{:.3g}", c.worst_variance),
             fmt::format("{:.2g}", c.dead * 100), fmt::format("{:.1e}{}", c.bias, c.biased ? "!" : ""),
             fmt::format("{:.0e}", c.bias_interval), fmt::format("{:.0f}", c.sample_ns),
             fmt::format("{:.1f}", c.sample_ns / c.floor_ns),
             c.pdf_ns > 0 ? fmt::format("{:.0f}", c.pdf_ns) : "-",
             fmt::format("{:.0f}", double(s.bytes) / 1024), fmt::format("{:.2f}", s.build_seconds)});
        for (std::size_t e = 0; e < lights.size(); ++e) {
          table.rows.back().push_back(fmt::format("{:.2e}", c.efficiency(e)));
        }
      }
    }
    context.print(to_text(table) + "\n");
  }
  Table scores{{"sampler", "kind", "materials", "efficiency", "biased cells", "faults"}, {}};
  for (const Score& s : v.scores) {
    if (s.materials + s.faults == 0) continue;
    scores.rows.push_back({s.sampler,
                           s.ours      ? "ours"
                           : s.general ? "general"
                                       : "special",
                           std::to_string(s.materials), fmt::format("{:.3g}", s.relative_efficiency),
                           std::to_string(s.biased_cells), std::to_string(s.faults)});
  }
  if (v.materials == 0) {
    context.print("no verdict: ours and a general competitor are wanted on one material at least\n");
    return;
  }
  context.print(to_text(scores));
  context.print(fmt::format(
      "\n{}  best of all general methods in geometric mean\n{}  best on nine materials in ten: {} of {}\n",
      v.best_in_mean ? "holds" : "fails", v.nine_in_ten ? "holds" : "fails", v.won, v.materials));
  for (const Loss& l : v.losses) {
    context.print(fmt::format(
        "loss  {}: {:.3g} of {}, most at {} deg under {}: it has {:.3g} of our RMSE^2, {:.3g} of our time\n",
        l.material, l.ratio, l.winner, l.theta_o_deg, l.light, l.error_ratio, l.time_ratio));
  }
}

int run_compare(const Context& context, const Options& given) {
  StudyOptions o;
  o.seed = context.seed;
  if (given.quick)
    o.samples = 1U << 13U, o.round_seconds = 5e-4, o.curve_repeats = 8, o.cubature_evaluations = 200'000;
  if (given.quick) o.curve_samples = 256;
  if (!given.theta_o_deg.empty()) o.theta_o_deg = parse_theta_o(given.theta_o_deg);
  const std::vector<const SamplerInfo*> wanted = chosen(given.samplers);
  std::vector<std::string> names = given.materials;
  if (names.empty()) names = default_materials(context, given.quick);
  // Everything is read before the long work begins.
  std::vector<StudyMaterial> materials;
  for (const std::string& name : names) {
    Material material = parse(context, name);
    materials.push_back({name, material, load_material(context, material)});
  }
  const std::vector<Environment> lights = read_lights(context, given);
  const Json key = key_of(o, lights, wanted);
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
        const Json whole{{"options", key}, {"result", json_of(*found[i])}};
        if (!kept[i].empty())
          write_file_atomically(kept[i], whole.dump(1, ' ', false, Json::error_handler_t::replace));
      }
      host.progress(float(++done) / float(materials.size()));
    }
  });
  std::vector<MaterialResult> all;
  for (auto& m : found) all.push_back(std::move(*m));
  const Verdict verdict = judge(all, samplers(), lights, o);
  std::string command = "reflectree compare";
  if (given.quick) command += " --quick";
  for (const std::string& m : given.materials) command += " '" + m + "'";
  const StudyMeta meta{command, REFLECTREE_VERSION, machine(), REFLECTREE_COMMIT};
  if (!given.csv.empty()) write_file_atomically(given.csv, csv_of(all, lights, o));
  if (!given.html.empty()) write_file_atomically(given.html, study_html(all, verdict, lights, o, meta));
  if (context.json) {
    Json json = Json::array();
    for (const MaterialResult& m : all) json.push_back(json_of(m));
    context.print_json("compare", {{"version", meta.version},
                                   {"commit", meta.commit},
                                   {"machine", meta.machine},
                                   {"options", key},
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
  auto o = std::make_shared<Options>();
  command
      ->add_option("MATERIAL", o->materials,
                   "Materials or files; nothing: the measured ones of the data folder, or models")
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
