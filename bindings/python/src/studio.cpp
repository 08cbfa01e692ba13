// SPDX-License-Identifier: Apache-2.0
// reflectree._studio: what needs the libraries of pictures and of the renderer. A module of its own, so that
// the package neither needs nor loads them (decision 0053).
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "brdf.hpp"
#include "error.hpp"
#include "host.hpp"
#include "reflectree/render/film/film.hpp"
#include "reflectree/study/doctor_page.hpp"
#include "reflectree/study/verdict.hpp"

namespace reflectree::python {

namespace {

using namespace study;

using Picture = nb::ndarray<nb::numpy, float, nb::ndim<3>>;

template <class T>
T named(const char* argument, const std::string& word, const std::map<std::string, T>& names) {
  const auto found = names.find(word);
  if (found != names.end()) return found->second;
  std::string all;
  for (const auto& [name, value] : names) all += (all.empty() ? "" : ", ") + name;
  throw Error("'" + word + "' is unknown", argument, "say one of " + all);
}

// R, G, B of each pixel, rows from the top.
Picture array_of(const Image& image) {
  const std::size_t width = std::size_t(image.width), height = std::size_t(image.height);
  auto* values = new float[3 * width * height];
  const nb::capsule owner(values, [](void* p) noexcept { delete[] static_cast<float*>(p); });
  for (std::size_t i = 0; i < width * height; ++i) {
    for (std::size_t c = 0; c < 3; ++c) values[3 * i + c] = image.values[i * image.channels.size() + c];
  }
  return Picture(values, {height, width, 3}, owner);
}

nb::tuple render_scene(const std::string& path, const std::string& xml,
                       const std::map<std::string, std::string>& defines, const std::string& sampler,
                       const std::string& integrator, const std::string& technique, int samples,
                       std::uint64_t seed, unsigned threads, nb::object progress) {
  using render::Technique;
  render::SceneOptions reading;
  reading.defines = defines;
  reading.sampler = sampler;
  render::RenderOptions how;
  how.samples = samples;
  how.seed = seed;
  how.technique = named<Technique>("technique", technique,
                                   {{"balance", Technique::balance},
                                    {"power", Technique::power},
                                    {"light", Technique::light},
                                    {"brdf", Technique::surface},
                                    {"resampled", Technique::resampled}});
  const auto method = integrator.empty() ? std::nullopt : render::method_of(integrator);
  if (!integrator.empty() && !method)
    throw Error("'" + integrator + "' is unknown", "integrator", "say path, direct, recursive or photons");
  const Host host = make_host(threads, std::move(progress));
  std::vector<std::string> notes;
  const Image image = [&] {
    const nb::gil_scoped_release no_gil;
    host.stage("building");
    render::Scene scene =
        xml.empty() ? render::load_scene(path, reading, host) : render::parse_scene(xml, path, reading, host);
    notes = scene.notes;
    if (method) scene.transport.method = *method;
    host.stage("rendering");
    Image done = render::render(scene, how, host);
    host.progress(1);
    return done;
  }();
  return nb::make_tuple(array_of(image), notes);
}

nb::dict cell_of(const std::string& material, const SamplerResult& s, double theta_o_deg,
                 const study::StudyCell& c, std::span<const Illumination> lights) {
  nb::dict row;
  row["material"] = material;
  row["sampler"] = s.sampler;
  row["theta_o_deg"] = theta_o_deg;
  row["target_variance"] = c.target_variance;
  row["sum_variance"] = c.sum_variance;
  row["worst_variance"] = c.worst_variance;
  row["by_density"] = c.by_density;
  row["dead"] = c.dead;
  row["bias"] = c.bias;
  row["bias_interval"] = c.bias_interval;
  row["biased"] = c.biased;
  row["sample_ns"] = c.sample_ns;
  row["pdf_ns"] = c.pdf_ns;
  row["floor_ns"] = c.floor_ns;
  row["bytes"] = s.bytes;
  row["build_seconds"] = s.build_seconds;
  nb::dict efficiency;
  for (std::size_t e = 0; e < lights.size(); ++e)
    efficiency[nb::str(lights[e].name.c_str())] = c.efficiency(e);
  row["efficiency"] = efficiency;
  return row;
}

nb::dict dict_of(const Verdict& v) {
  nb::list scores, losses;
  for (const Score& s : v.scores) {
    if (s.materials + s.faults == 0) continue;
    nb::dict d;
    d["sampler"] = s.sampler;
    d["kind"] = s.ours ? "ours" : s.general ? "general" : "special";
    d["materials"] = s.materials;
    d["efficiency"] = s.relative_efficiency;
    d["biased_cells"] = s.biased_cells;
    d["faults"] = s.faults;
    scores.append(d);
  }
  for (const Loss& l : v.losses) {
    nb::dict d;
    d["material"] = l.material;
    d["winner"] = l.winner;
    d["ratio"] = l.ratio;
    d["theta_o_deg"] = l.theta_o_deg;
    d["light"] = l.light;
    d["error_ratio"] = l.error_ratio;
    d["time_ratio"] = l.time_ratio;
    d["cause"] = cause_of(l);
    losses.append(d);
  }
  nb::dict result;
  result["scores"] = scores;
  result["losses"] = losses;
  result["materials"] = v.materials;
  result["won"] = v.won;
  result["best_in_mean"] = v.best_in_mean;
  result["nine_in_ten"] = v.nine_in_ten;
  return result;
}

nb::dict compare(const std::vector<const PyBrdf*>& brdfs, const std::vector<std::string>& names,
                 const std::vector<std::string>& wanted, const std::vector<double>& theta_o_deg, bool quick,
                 std::uint64_t seed, unsigned threads, nb::object progress) {
  StudyOptions options = quick ? quick_study() : StudyOptions{};
  options.seed = seed;
  if (!theta_o_deg.empty()) options.theta_o_deg = theta_o_deg;
  std::vector<const SamplerInfo*> infos;
  for (const std::string& name : wanted) {
    infos.push_back(find_sampler(name));
    if (!infos.back()) throw Error("no sampler '" + name + "'", "samplers", "choose of rt.samplers()");
  }
  if (wanted.empty()) {
    for (const SamplerInfo& info : samplers()) infos.push_back(&info);
  }
  const Host host = make_host(threads, std::move(progress));
  const std::vector<Illumination> lights = procedural_illuminations();
  std::vector<MaterialResult> all;
  const Verdict verdict = [&] {
    const nb::gil_scoped_release no_gil;
    for (std::size_t i = 0; i < brdfs.size(); ++i) {
      host.stage(names[i].c_str());
      all.push_back(measure({names[i], brdfs[i]->material, brdfs[i]->f}, infos, lights, options, host));
      host.progress(float(i + 1) / float(brdfs.size()));
    }
    return judge(all, samplers(), lights, options);
  }();
  nb::list rows, faults;
  for (const MaterialResult& m : all) {
    for (const SamplerResult& s : m.samplers) {
      if (!s.fault.empty()) faults.append(nb::make_tuple(m.material, s.sampler, s.fault));
      for (std::size_t i = 0; i < s.cells.size(); ++i)
        rows.append(cell_of(m.material, s, options.theta_o_deg[i], s.cells[i], lights));
    }
  }
  nb::dict result;
  result["rows"] = rows;
  result["faults"] = faults;
  result["verdict"] = dict_of(verdict);
  return result;
}

}  // namespace

}  // namespace reflectree::python

NB_MODULE(_studio_core, m) {
  namespace nb = nanobind;
  using namespace reflectree;
  python::translate_errors();
  m.def("render", &python::render_scene, nb::arg("path"), nb::kw_only(), nb::arg("xml"), nb::arg("defines"),
        nb::arg("sampler"), nb::arg("integrator"), nb::arg("technique"), nb::arg("samples"), nb::arg("seed"),
        nb::arg("threads"), nb::arg("progress").none());
  m.def("compare", &python::compare, nb::arg("brdfs"), nb::kw_only(), nb::arg("names"), nb::arg("samplers"),
        nb::arg("theta_o_deg"), nb::arg("quick"), nb::arg("seed"), nb::arg("threads"),
        nb::arg("progress").none());
  m.def(
      "doctor_html",
      [](const Diagnosis& diagnosis, const std::string& command, const std::string& version) {
        return study::doctor_html(diagnosis, {command, version, "", ""});
      },
      nb::arg("diagnosis"), nb::arg("command"), nb::arg("version"));
}
