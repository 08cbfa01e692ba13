// SPDX-License-Identifier: Apache-2.0
#include "brdf.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "reflectree/brdf/material/registry.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/open.hpp"

namespace reflectree::python {

namespace {

FunctionOwner& owner_of(PyBrdf& brdf) { return brdf.owner; }

void eval_into(const PyBrdf& brdf, const Input& wo, const Input& wi, const Output& out, bool cosine) {
  const auto channels = std::size_t(brdf.f.channels());
  const Rows wo_rows(wo, 3, "wo"), wi_rows(wi, 3, "wi");
  const Rows out_rows(out, brdf.function && !brdf.function->has_channel_axis() ? 0 : channels, "out");
  std::vector<Direction> o, i;
  std::vector<float> values;
  in_pieces(out_rows.size(), brdf.piece(), [&](std::size_t first, std::size_t count) {
    o.resize(count), i.resize(count), values.resize(count * channels);
    read_directions(wo_rows, first, o);
    read_directions(wi_rows, first, i);
    brdf.f.eval(o, i, values);
    for (std::size_t k = 0; cosine && k < values.size(); ++k) values[k] *= max(i[k / channels].z, 0.f);
    out_rows.write(first, std::span<const float>(values));
  });
}

}  // namespace

void bind_brdf(nb::module_& m) {
  nb::class_<PyBrdf>(m, "Brdf", nb::type_slots(Collected<PyBrdf, owner_of>::slots))
      .def_static(
          "from_text",
          [](const std::string& text, const std::string& beside) {
            const nb::gil_scoped_release no_gil;
            const FilePlaces places{"", beside};
            PyBrdf brdf{open_brdf(text, places)};
            if (names_sampler_file(text, places)) return brdf;
            brdf.material = parse_material(text, places);
            brdf.lanes = lane_function(brdf.material);
            return brdf;
          },
          nb::arg("text"), nb::arg("beside"))
      .def_static(
          "from_file",
          [](const std::string& path, const std::string& member) {
            const nb::gil_scoped_release no_gil;
            return PyBrdf{load_brdf(path, member)};
          },
          nb::arg("path"), nb::arg("member"))
      .def_static(
          "from_function",
          [](nb::object f, std::string name, bool double_precision) {
            const FunctionOwner owner(f);
            PythonBrdf function(owner.place(), std::move(name), double_precision);
            return PyBrdf{AnyBrdf(function), function, owner};
          },
          nb::arg("function"), nb::arg("name"), nb::arg("double_precision"))
      .def_prop_ro("name", [](const PyBrdf& b) { return b.f.traits().name; })
      .def_prop_ro("channels", [](const PyBrdf& b) { return b.f.channels(); })
      .def_prop_ro("is_function", [](const PyBrdf& b) { return b.function.has_value(); })
      .def_prop_ro("has_channel_axis",
                   [](const PyBrdf& b) { return !b.function || b.function->has_channel_axis(); })
      .def_prop_ro("calls",
                   [](const PyBrdf& b) {
                     const PythonBrdf::Calls calls = b.function ? b.function->calls() : PythonBrdf::Calls{};
                     return nb::make_tuple(calls.count, calls.directions);
                   })
      .def("eval", &eval_into, nb::arg("wo").noconvert(), nb::arg("wi").noconvert(),
           nb::arg("out").noconvert(), nb::arg("cosine"));
  m.def("list_members", &list_members, nb::arg("path"));
  m.def("model_names", [] {
    std::vector<std::string> names;
    for (const ModelInfo& info : models()) names.emplace_back(info.name);
    return names;
  });
}

}  // namespace reflectree::python
