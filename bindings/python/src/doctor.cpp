// SPDX-License-Identifier: Apache-2.0
// doctor: judges samplers of ours, competitors by name, and three functions of Python.
#include "reflectree/verify/doctor.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <map>

#include "host.hpp"
#include "judges.hpp"
#include "reflectree/peers/registry.hpp"
#include "rounds.hpp"

namespace reflectree::python {

namespace {

using Doubles = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// Rows of numbers as an array that Python owns, and back.
nb::object array_of(std::span<const Direction> w) {
  nb::object rows = nb::module_::import_("numpy").attr("empty")(nb::make_tuple(3, w.size()));
  const auto array = nb::cast<nb::ndarray<double, nb::shape<3, -1>, nb::c_contig, nb::device::cpu>>(rows);
  double *x = array.data(), *y = x + w.size(), *z = y + w.size();
  for (std::size_t i = 0; i < w.size(); ++i)
    x[i] = double(w[i].x), y[i] = double(w[i].y), z[i] = double(w[i].z);
  return rows.attr("T");
}
void take(const nb::object& answer, std::size_t rows, std::size_t columns, const double*& values) {
  const auto array = nb::cast<Doubles>(answer);
  if (array.shape(0) != rows || array.shape(1) != columns)
    throw Error("an answer of another shape", "rt.doctor", "report this, please: the package checks shapes");
  values = array.data();
}

// Three functions of Python, whose answers the package has checked: eval and pdf give (n, channels) and (n, 1),
// sample gives (n, 5 + channels): wi, pdf, whether there is a direction, values. Borrows them; pdf may be None.
struct Triple {
  nb::object eval, sample, pdf;
  std::size_t calls = 0, directions = 0;

  // Both directions above the surface; elsewhere the answer is 0 and f is not asked.
  void ask(const nb::object& f, std::span<const Direction> wo, std::span<const Direction> wi,
           std::span<double> out) {
    std::vector<Direction> o, i;
    std::vector<std::size_t> place;
    for (std::size_t k = 0; k < wo.size(); ++k) {
      if (wo[k].z > 0 && wi[k].z > 0) o.push_back(wo[k]), i.push_back(wi[k]), place.push_back(k);
    }
    std::fill(out.begin(), out.end(), 0.);
    if (place.empty()) return;
    const std::size_t width = out.size() / wo.size();
    const nb::gil_scoped_acquire gil;
    ++calls, directions += place.size();
    const nb::object answer = f(array_of(o), array_of(i));
    const double* row = nullptr;
    take(answer, place.size(), width, row);
    for (const std::size_t k : place) {
      std::copy_n(row, width, out.begin() + std::ptrdiff_t(k * width));
      row += width;
    }
  }
  void draw(std::span<const Direction> wo, std::uint64_t seed, std::span<PatientDraw> draws,
            std::span<double> out) {
    if (wo.empty()) return;
    const std::size_t channels = out.size() / wo.size(), width = 5 + channels;
    const nb::gil_scoped_acquire gil;
    ++calls, directions += wo.size();
    const nb::object answer = sample(array_of(wo), seed >> 1U);
    const double* row = nullptr;
    take(answer, wo.size(), width, row);
    for (std::size_t i = 0; i < wo.size(); ++i, row += width) {
      draws[i] = {{float(row[0]), float(row[1]), float(row[2])}, row[3], row[4] != 0};
      std::copy_n(row + 5, channels, out.begin() + std::ptrdiff_t(i * channels));
    }
  }
  Patient patient(const std::string& name, int channels) {
    Patient p;
    p.name = name;
    p.channels = channels;
    p.concurrent = false;
    p.eval = [this](auto wo, auto wi, auto out) { ask(eval, wo, wi, out); };
    p.sample = [this](auto wo, std::uint64_t seed, auto draws, auto values) {
      draw(wo, seed, draws, values);
    };
    if (!pdf.is_none()) p.pdf = [this](auto wo, auto wi, auto out) { ask(pdf, wo, wi, out); };
    return p;
  }
};

// A sampler as Python's methods draw from it. Borrows it.
Patient patient_of(const PySampler& s, Mode mode) {
  Patient p = patient(s.brdf.f);
  p.sample = [&s, mode](std::span<const Direction> wo, std::uint64_t seed, std::span<PatientDraw> draws,
                        std::span<double> values) {
    Pcg32 u(seed, seed >> 32U);
    const DrawnRows drawn = draw(s, mode, wo, u);
    for (std::size_t i = 0; i < wo.size(); ++i)
      draws[i] = {drawn.wi[i], double(drawn.pdf[i]), drawn.valid[i] != 0};
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = double(drawn.weight[k]);
  };
  p.pdf = [&s, mode](std::span<const Direction> wo, std::span<const Direction> wi, std::span<double> out) {
    std::vector<float> values(mode == Mode::exact ? wo.size() * std::size_t(s.brdf.f.channels()) : 0);
    std::vector<float> densities(wo.size());
    if (mode == Mode::exact) s.brdf.f.eval(wo, wi, values);
    densities_into(s, mode != Mode::exact, wo, wi, values, densities);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = double(densities[k]);
  };
  return p;
}

DoctorOptions options_of(const std::string& effort, std::uint64_t seed) {
  const std::map<std::string, DoctorEffort> efforts{{"quick", DoctorEffort::quick},
                                                    {"default", DoctorEffort::normal},
                                                    {"thorough", DoctorEffort::thorough}};
  const auto found = efforts.find(effort);
  if (found == efforts.end())
    throw Error("'" + effort + "' is no effort", "effort", "say quick, default or thorough");
  DoctorOptions options = doctor_options(found->second);
  options.seed = seed;
  return options;
}

Diagnosis examine(const Patient& patient, const std::string& effort, std::uint64_t seed, const Host& host) {
  const DoctorOptions options = options_of(effort, seed);
  const nb::gil_scoped_release no_gil;
  return doctor(patient, options, host);
}

EvalKind eval_kind(const std::string& word) {
  if (word == "f") return EvalKind::f;
  if (word == "f_cos") return EvalKind::f_cos;
  if (word == "detect") return EvalKind::detect;
  throw Error("'" + word + "' is nothing that eval returns", "eval_returns", "say f, f_cos or detect");
}
ValueKind value_kind(const std::string& word) {
  if (word == "weight") return ValueKind::weight;
  if (word == "f_cos") return ValueKind::f_cos;
  if (word == "f") return ValueKind::f;
  if (word == "none") return ValueKind::none;
  if (word == "detect") return ValueKind::detect;
  throw Error("'" + word + "' is nothing that sample returns", "sample_returns",
              "say weight, f_cos, f, none or detect");
}

nb::tuple diagnose_functions(nb::object eval, nb::object sample, nb::object pdf, int channels,
                             const std::string& name, const std::string& eval_returns,
                             const std::string& sample_returns, const std::string& effort, std::uint64_t seed,
                             nb::object progress) {
  Triple triple{std::move(eval), std::move(sample), std::move(pdf)};
  Patient patient = triple.patient(name, channels);
  patient.eval_kind = eval_kind(eval_returns);
  patient.value_kind = value_kind(sample_returns);
  Diagnosis d = examine(patient, effort, seed, make_host(1, std::move(progress)));
  return nb::make_tuple(std::move(d), triple.calls, triple.directions);
}

Diagnosis diagnose_sampler(const PySampler& s, const std::string& mode, const std::string& name,
                           const std::string& effort, std::uint64_t seed, unsigned threads,
                           nb::object progress) {
  Patient patient = patient_of(s, mode == "exact"      ? Mode::exact
                                  : mode == "one-shot" ? Mode::one_shot
                                                       : Mode::points);
  patient.name = name;
  return examine(patient, effort, seed, make_host(s.brdf.function ? 1 : threads, std::move(progress)));
}

// A competitor, built here.
Diagnosis diagnose_peer(const PyBrdf& brdf, const std::string& sampler, const std::string& name,
                        const std::string& effort, std::uint64_t seed, unsigned threads,
                        nb::object progress) {
  const SamplerInfo* info = find_sampler(sampler);
  if (!info) throw Error("no sampler '" + sampler + "'", "sampler", "choose of rt.samplers()");
  const Host host = make_host(brdf.function ? 1 : threads, std::move(progress));
  const PeerSubject subject{brdf.f, brdf.material, {}, nullptr};
  auto made = [&] {
    const nb::gil_scoped_release no_gil;
    return info->make(subject, host);
  }();
  if (!made)
    throw Error("the sampler '" + sampler + "' does not serve this material", name,
                "choose another of rt.samplers()");
  Patient p = patient(brdf.f, *made);
  p.name = name;
  return examine(p, effort, seed, host);
}

nb::tuple tuple_of(Direction w) { return nb::make_tuple(w.x, w.y, w.z); }

nb::list list_of(const std::vector<VerifyFigure>& figures) {
  nb::list list;
  for (const VerifyFigure& f : figures) list.append(nb::make_tuple(f.name, f.where, f.value));
  return list;
}

nb::list findings_of(const Diagnosis& d) {
  nb::list list;
  for (const Finding& f : d.findings) {
    nb::object evidence = nb::none();
    if (f.evidence.wo != Direction{}) {
      evidence = nb::make_tuple(tuple_of(f.evidence.wo), tuple_of(f.evidence.wi), f.evidence.quantity,
                                f.evidence.found, f.evidence.expected);
    }
    list.append(nb::make_tuple(f.check, f.cause, f.words, f.fault, evidence, list_of(f.figures), to_text(f)));
  }
  return list;
}

nb::list checks_of(const Diagnosis& d) {
  nb::list list;
  for (const CheckResult& c : d.checks) {
    list.append(nb::make_tuple(c.name, c.way, c.where, c.passed, c.decided, c.statistic, c.threshold,
                               c.p_value, c.detail));
  }
  return list;
}

}  // namespace

void bind_doctor(nb::module_& m) {
  nb::class_<Diagnosis>(m, "Diagnosis")
      .def_ro("subject", &Diagnosis::subject)
      .def_ro("conventions", &Diagnosis::conventions)
      .def_prop_ro("healthy", &Diagnosis::healthy)
      .def_prop_ro("checks", &checks_of)
      .def_prop_ro("findings", &findings_of)
      .def_prop_ro("figures", [](const Diagnosis& d) { return list_of(d.figures); });
  m.def("diagnose_functions", &diagnose_functions, nb::arg("eval"), nb::arg("sample"), nb::arg("pdf").none(),
        nb::kw_only(), nb::arg("channels"), nb::arg("name"), nb::arg("eval_returns"),
        nb::arg("sample_returns"), nb::arg("effort"), nb::arg("seed"), nb::arg("progress").none());
  m.def("diagnose_sampler", &diagnose_sampler, nb::arg("sampler"), nb::kw_only(), nb::arg("mode"),
        nb::arg("name"), nb::arg("effort"), nb::arg("seed"), nb::arg("threads"), nb::arg("progress").none());
  m.def("diagnose_peer", &diagnose_peer, nb::arg("brdf"), nb::kw_only(), nb::arg("sampler"), nb::arg("name"),
        nb::arg("effort"), nb::arg("seed"), nb::arg("threads"), nb::arg("progress").none());
  m.def("doctor_causes", [] {
    nb::dict causes;
    for (const DoctorCause& c : doctor_causes())
      causes[nb::str(c.key.data(), c.key.size())] = nb::str(c.meaning.data(), c.meaning.size());
    return causes;
  });
  m.def("sampler_names", [] {
    nb::dict names;
    for (const SamplerInfo& info : samplers())
      names[nb::str(info.name.data(), info.name.size())] = nb::str(info.summary.data(), info.summary.size());
    return names;
  });
}

}  // namespace reflectree::python
