// SPDX-License-Identifier: Apache-2.0
// A family's sampler: its parameters come with every direction, as rows of an array.
#include "family.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "host.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "reflectree/sampler/member.hpp"
#include "reflectree/simd/family_rounds.hpp"
#include "sample_output.hpp"

namespace reflectree::python {

namespace {

FunctionOwner& owner_of(PyFamily& f) { return f.owner; }

// A function of Python wants few calls.
std::size_t piece_of(const PyFamily& f) { return f.function ? 4 * python_batch : 1024; }
std::size_t width_of(const PyFamily& f) {
  return f.function && !f.function->has_channel_axis() ? 0 : std::size_t(f.family.channels());
}

Parameters parameters_from(const PyFamily& f, const std::vector<float>& numbers) {
  Parameters at{};
  std::copy_n(numbers.begin(), std::min(numbers.size(), f.family.ranges().size()), at.begin());
  return at;
}

// In the order of the ranges. Throws Error outside of them.
class ParameterRows {
 public:
  ParameterRows(const PyFamily& family, const Input& at)
      : ranges_(family.family.ranges()), rows_(at, ranges_.size(), "parameters") {}
  std::span<const Parameters> read(std::size_t first, std::size_t count) {
    numbers_.resize(count * ranges_.size()), at_.resize(count);
    rows_.read(first, numbers_);
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < ranges_.size(); ++i) {
        const ParameterRange& range = ranges_[i];
        const double value = numbers_[k * ranges_.size() + i];
        at_[k][i] = float(value);
        if (!range.contains(at_[k][i])) {
          throw Error(range.name + " is " + std::to_string(value), rows_.place(first + k),
                      "the sampler serves " + std::to_string(range.lo) + " to " + std::to_string(range.hi));
        }
      }
    }
    return at_;
  }

 private:
  const std::vector<ParameterRange>& ranges_;
  Rows rows_;
  std::vector<double> numbers_;
  std::vector<Parameters> at_;
};

void sample_into(const PyFamily& f, bool one_shot, const Input& wo, const Input& at,
                 const std::optional<Input>& u, std::uint64_t seed, std::uint64_t stream, const Output& wi,
                 const Output& pdf, const Output& weight, const Output& valid) {
  const int channels = f.family.channels();
  SampleOutput out(channels, width_of(f), wi, pdf, weight, valid);
  const Rows wo_rows(wo, 3, "wo");
  ParameterRows parameters(f, at);
  std::optional<Rows> points;
  if (u) points.emplace(*u, 2, "u");
  Pcg32 random(seed, stream);
  std::vector<Direction> o;
  std::vector<Vec2<double>> uniforms;
  in_pieces(out.size(), piece_of(f), [&](std::size_t first, std::size_t count) {
    o.resize(count);
    read_directions(wo_rows, first, o);
    const std::span<const Parameters> p = parameters.read(first, count);
    if (points) uniforms.resize(count), read_points(*points, first, uniforms);
    const SampleRows rows = out.buffers(count);
    if (f.function) {
      if (one_shot) {
        sample_rounds(f.sampler.one_shot, o, p, uniforms, random, rows, python_batch);
      } else {
        sample_rounds(f.sampler.exact, o, p, random, rows, python_batch);
      }
      return out.write(first);
    }
    for (std::size_t k = 0; k < count; ++k) {
      const auto s = !one_shot ? f.sampler.exact.sample(o[k], p[k], random)
                     : points  ? f.sampler.one_shot.sample(o[k], p[k], uniforms[k].x, uniforms[k].y)
                               : f.sampler.one_shot.sample(o[k], p[k], random);
      rows.valid[k] = s.has_value();
      rows.wi[k] = s ? s->wi : Direction{}, rows.pdf[k] = s ? s->pdf : 0;
      for (int c = 0; c < channels; ++c)
        rows.weight[k * std::size_t(channels) + std::size_t(c)] = s ? s->weight[c] : 0;
    }
    out.write(first);
  });
}

// f, where wanted with the cosine, and the density of a mode, per solid angle; either may be left out.
void eval_pdf_into(const PyFamily& f, bool one_shot, const Input& wo, const Input& wi, const Input& at,
                   const std::optional<Output>& value, const std::optional<Output>& pdf, bool cosine) {
  const auto channels = std::size_t(f.family.channels());
  const Rows wo_rows(wo, 3, "wo"), wi_rows(wi, 3, "wi");
  ParameterRows parameters(f, at);
  std::optional<Rows> value_rows, pdf_rows;
  if (value) value_rows.emplace(*value, width_of(f), "out");
  if (pdf) pdf_rows.emplace(*pdf, 0, "out");
  std::vector<Direction> o, i;
  std::vector<float> values, densities;
  std::vector<std::size_t> above;
  std::vector<ShadingGeometry<float>> geometry;
  std::vector<Parameters> members;
  std::vector<float> asked;
  in_pieces(value ? value_rows->size() : pdf_rows->size(), piece_of(f),
            [&](std::size_t first, std::size_t count) {
              o.resize(count), i.resize(count), values.assign(count * channels, 0), densities.resize(count);
              read_directions(wo_rows, first, o);
              read_directions(wi_rows, first, i);
              const std::span<const Parameters> p = parameters.read(first, count);
              above.clear(), geometry.clear(), members.clear();
              for (std::size_t k = 0; k < count; ++k) {
                if (!(o[k].z > 0 && i[k].z > 0)) continue;
                above.push_back(k), geometry.push_back(shading_geometry(o[k], i[k])), members.push_back(p[k]);
              }
              if (value || !one_shot) {
                asked.resize(above.size() * channels);
                f.family.eval(geometry, members, asked);
                for (std::size_t k = 0; k < above.size(); ++k)
                  std::copy_n(&asked[k * channels], channels, &values[above[k] * channels]);
              }
              for (std::size_t k = 0; pdf && k < count; ++k) {
                const float albedo = one_shot ? 0 : f.sampler.exact.borrowed(p[k]).albedo(o[k]);
                densities[k] = one_shot     ? f.sampler.one_shot.pdf(o[k], i[k], p[k])
                               : albedo > 0 ? f.packed->target(&values[k * channels], int(channels)) /
                                                  albedo * max(i[k].z, 0.f)
                                            : 0;
              }
              for (std::size_t k = 0; cosine && k < values.size(); ++k)
                values[k] *= max(i[k / channels].z, 0.f);
              if (value) value_rows->write(first, std::span<const float>(values));
              if (pdf) pdf_rows->write(first, std::span<const float>(densities));
            });
}

template <float (ExactSampler<FamilyMember<AnyFamily>, const PackedSampler*>::*of)(Direction) const>
void of_viewer_into(const PyFamily& f, const Input& wo, const Input& at, const Output& out, float scale) {
  const Rows wo_rows(wo, 3, "wo"), out_rows(out, 0, "out");
  ParameterRows parameters(f, at);
  std::vector<Direction> o;
  std::vector<float> values;
  in_pieces(out_rows.size(), piece_of(f), [&](std::size_t first, std::size_t count) {
    o.resize(count), values.resize(count);
    read_directions(wo_rows, first, o);
    const std::span<const Parameters> p = parameters.read(first, count);
    for (std::size_t k = 0; k < count; ++k) values[k] = (f.sampler.exact.borrowed(p[k]).*of)(o[k]) / scale;
    out_rows.write(first, std::span<const float>(values));
  });
}

using Ranges = std::vector<std::tuple<std::string, float, float>>;

// A family whose function is one of Python; `data`: of its sampler.
template <class Data>
PyFamily family_of(const nb::object& f, std::string name, bool double_precision,
                   std::vector<ParameterRange> ranges, const Data& data) {
  const FunctionOwner owner(f);
  PythonBrdf function(owner.place(), std::move(name), double_precision, ranges);
  const AnyFamily family(reflectree::family(PythonFamily(function), std::move(ranges)));
  return {open_family(family, data(family)), function, owner};
}

// From canonical data: the family of a material's text, or of the function, unless it is None.
PyFamily family_again(SamplerData data, const nb::object& f, std::string name, bool double_precision) {
  if (f.is_none()) {
    const nb::gil_scoped_release no_gil;
    return {open_family(std::move(data), {})};
  }
  std::vector<ParameterRange> ranges;
  for (const KnownParameter& p : data.parameters) ranges.push_back(p.range);
  return family_of(f, std::move(name), double_precision, std::move(ranges),
                   [&](const AnyFamily&) { return std::move(data); });
}

}  // namespace

void bind_family(nb::module_& m) {
  using Borrowed = ExactSampler<FamilyMember<AnyFamily>, const PackedSampler*>;
  const auto array = [](const char* name) { return nb::arg(name).noconvert(); };
  nb::class_<PyFamily>(m, "Family", nb::type_slots(Collected<PyFamily, owner_of>::slots))
      .def_static(
          "build",
          [](const std::string& text, const std::string& target, int channel, float expected_trials,
             float one_shot_variance, float albedo_error, std::uint64_t seed, std::uint64_t max_evaluations,
             unsigned threads, nb::object progress) {
            const BuildOptions options = build_options(target, channel, expected_trials, one_shot_variance,
                                                       albedo_error, seed, max_evaluations);
            const Host host = make_host(threads, std::move(progress));
            const nb::gil_scoped_release no_gil;
            return PyFamily{open_family(text, {}, options, host)};
          },
          nb::arg("text"), nb::kw_only(), nb::arg("target"), nb::arg("channel"), nb::arg("expected_trials"),
          nb::arg("one_shot_variance"), nb::arg("albedo_error"), nb::arg("seed"), nb::arg("max_evaluations"),
          nb::arg("threads"), nb::arg("progress").none())
      .def_static(
          "build_function",
          [](const nb::object& f, std::string name, bool double_precision, const Ranges& given,
             const std::string& target, int channel, float expected_trials, float one_shot_variance,
             float albedo_error, std::uint64_t seed, std::uint64_t max_evaluations, unsigned threads,
             nb::object progress) {
            const BuildOptions options = build_options(target, channel, expected_trials, one_shot_variance,
                                                       albedo_error, seed, max_evaluations);
            std::vector<ParameterRange> ranges;
            for (const auto& [parameter, lo, hi] : given) ranges.push_back({parameter, lo, hi});
            return family_of(f, std::move(name), double_precision, std::move(ranges),
                             [&](const AnyFamily& family) {
                               const Host host = make_host(threads, std::move(progress));
                               const nb::gil_scoped_release no_gil;
                               return build(family, options, host);
                             });
          },
          nb::arg("function"), nb::arg("name"), nb::arg("double_precision"), nb::arg("ranges"), nb::kw_only(),
          nb::arg("target"), nb::arg("channel"), nb::arg("expected_trials"), nb::arg("one_shot_variance"),
          nb::arg("albedo_error"), nb::arg("seed"), nb::arg("max_evaluations"), nb::arg("threads"),
          nb::arg("progress").none())
      .def_static(
          "from_file",
          [](const std::string& path, const nb::object& f, std::string name, bool double_precision) {
            if (!f.is_none()) return family_again(load_sampler(path), f, std::move(name), double_precision);
            const nb::gil_scoped_release no_gil;
            return PyFamily{open_family(path)};
          },
          nb::arg("path"), nb::arg("function").none(), nb::arg("name"), nb::arg("double_precision"))
      .def_static(
          "from_bytes",
          [](const nb::bytes& bytes, const std::string& where, const nb::object& f, std::string name,
             bool double_precision) {
            const auto* begin = static_cast<const std::uint8_t*>(bytes.data());
            return family_again(decode_sampler(Bytes(begin, begin + bytes.size()), where), f, std::move(name),
                                double_precision);
          },
          nb::arg("bytes"), nb::arg("where"), nb::arg("function").none(), nb::arg("name"),
          nb::arg("double_precision"))
      .def("to_bytes",
           [](const PyFamily& f) {
             const Bytes bytes = encode_sampler(f.data);
             return nb::bytes(bytes.data(), bytes.size());
           })
      .def(
          "save", [](const PyFamily& f, const std::string& path) { save_sampler(path, f.data); },
          nb::arg("path"))
      .def("sample", &sample_into, nb::arg("one_shot"), array("wo"), array("parameters"), array("u").none(),
           nb::arg("seed"), nb::arg("stream"), array("wi"), array("pdf"), array("weight"), array("valid"))
      .def("eval_pdf", &eval_pdf_into, nb::arg("one_shot"), array("wo"), array("wi"), array("parameters"),
           array("f").none(), array("pdf").none(), nb::arg("cosine"))
      .def(
          "albedo",
          [](const PyFamily& f, const Input& wo, const Input& at, const Output& out) {
            of_viewer_into<&Borrowed::albedo>(f, wo, at, out, f.data.target.scale);
          },
          array("wo"), array("parameters"), array("out"))
      .def(
          "expected_trials",
          [](const PyFamily& f, const Input& wo, const Input& at, const Output& out) {
            of_viewer_into<&Borrowed::expected_trials>(f, wo, at, out, 1);
          },
          array("wo"), array("parameters"), array("out"))
      .def(
          "member",
          [](const PyFamily& f, const std::vector<float>& at) {
            OpenedSampler member = open_member(f, parameters_from(f, at));
            PyBrdf brdf{std::move(member.f)};
            brdf.material = parse_material(member.data.material, {});
            brdf.lanes = lane_function(brdf.material);
            return PySampler(std::move(brdf), std::move(member.data));
          },
          nb::arg("parameters"))
      .def(
          "member_of",
          [](const PyFamily& f, const PyBrdf& brdf, const std::vector<float>& at) {
            return PySampler(brdf, member_data(f.data, parameters_from(f, at), brdf.f.traits().name,
                                               probe_identity(brdf.f, f.data.target)));
          },
          nb::arg("brdf"), nb::arg("parameters"))
      .def(
          "tables", [](const PyFamily& f, bool one_shot) { return tables_of(*f.packed, f.data, one_shot); },
          nb::arg("one_shot"))
      .def_prop_ro("domain", [](const PyFamily& f) { return std::string(name_of(f.data.domain.kind)); })
      .def_prop_ro("isotropic", [](const PyFamily& f) { return f.data.frame.isotropic(); })
      .def_prop_ro("name", [](const PyFamily& f) { return f.data.material; })
      .def_prop_ro("channels", [](const PyFamily& f) { return f.family.channels(); })
      .def_prop_ro("has_channel_axis", [](const PyFamily& f) { return width_of(f) > 0; })
      .def_prop_ro("ranges",
                   [](const PyFamily& f) {
                     nb::dict ranges;
                     for (const ParameterRange& r : f.family.ranges())
                       ranges[r.name.c_str()] = nb::make_tuple(r.lo, r.hi);
                     return ranges;
                   })
      .def_prop_ro("report", [](const PyFamily& f) { return report_of(f.data.report); })
      .def_prop_ro("nbytes", [](const PyFamily& f) { return bytes_of(*f.packed); })
      .def_prop_ro("leaf_counts", [](const PyFamily& f) {
        return nb::make_tuple(f.packed->exact.leaves.size(), f.packed->one_shot.leaves.size());
      });
  m.def(
      "names_family", [](const std::string& text) { return names_family(text, {}); }, nb::arg("text"));
  m.attr("unnamed_family") = Family<detail::UnitFamily>{}.name;  // the material of a family of a function
}

}  // namespace reflectree::python
