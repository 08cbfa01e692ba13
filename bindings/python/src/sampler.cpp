// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "brdf.hpp"
#include "host.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "reflectree/simd/sample_rounds.hpp"
#include "sample_output.hpp"
#include "sampler.hpp"

namespace reflectree::python {

PySampler::PySampler(PyBrdf of, SamplerData the_data)
    : brdf(std::move(of)), data(std::move(the_data)), sampler(make_sampler(brdf.f, data)) {}

void densities_into(const PySampler& s, bool one_shot, std::span<const Direction> wo,
                    std::span<const Direction> wi, std::span<const float> values, std::span<float> out) {
  const auto channels = std::size_t(s.brdf.f.channels());
  const Target& target = s.sampler.exact.packed().target;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const float albedo = one_shot ? 0 : s.sampler.exact.albedo(wo[k]);
    out[k] = one_shot     ? s.sampler.one_shot.pdf(wo[k], wi[k])
             : albedo > 0 ? target(&values[k * channels], int(channels)) / albedo * max(wi[k].z, 0.f)
                          : 0;
  }
}

namespace {

TargetKind target_kind(const std::string& name) {
  if (name == "norm") return TargetKind::norm;
  if (name == "luminance") return TargetKind::luminance;
  if (name == "maximum") return TargetKind::maximum;
  if (name == "channel") return TargetKind::channel;
  throw Error("no target is called '" + name + "'", "target",
              "say norm, luminance, maximum or a channel's number");
}

}  // namespace

BuildOptions build_options(const std::string& target, int channel, float expected_trials,
                           float one_shot_variance, float albedo_error, std::uint64_t seed,
                           std::uint64_t max_evaluations) {
  BuildOptions options;
  options.target.kind = target_kind(target);
  options.target.index = std::uint16_t(channel);
  options.expected_trials = expected_trials;
  options.one_shot_variance = one_shot_variance;
  options.albedo_error = albedo_error;
  options.seed = seed;
  options.max_evaluations = max_evaluations;
  return options;
}

nb::dict report_of(const BuildReport& r) {
  nb::dict report;
  report["expected_trials"] = r.expected_trials;
  report["overshoot_mass"] = r.overshoot_mass;
  report["one_shot_variance"] = r.one_shot_variance;
  report["asymmetry"] = r.asymmetry;
  report["evaluations"] = r.evaluations;
  report["notes"] = r.notes;
  return report;
}

namespace {

FunctionOwner& owner_of(PySampler& s) { return s.brdf.owner; }

std::size_t width_of(const PyBrdf& brdf) {
  return brdf.function && !brdf.function->has_channel_axis() ? 0 : std::size_t(brdf.f.channels());
}

void sample_into(const PySampler& s, bool one_shot, const Input& wo, const std::optional<Input>& u,
                 std::uint64_t seed, std::uint64_t stream, const Output& wi, const Output& pdf,
                 const Output& weight, const Output& valid) {
  SampleOutput out(s.brdf.f.channels(), width_of(s.brdf), wi, pdf, weight, valid);
  const Rows wo_rows(wo, 3, "wo");
  std::optional<Rows> points;
  if (u) points.emplace(*u, 2, "u");
  Pcg32 random(seed, stream);
  const LaneFunction* lanes = s.brdf.lanes.get();
  std::vector<Direction> directions;
  std::vector<Vec2<double>> uniforms;
  in_pieces(out.size(), s.brdf.piece(), [&](std::size_t first, std::size_t count) {
    directions.resize(count);
    read_directions(wo_rows, first, directions);
    if (points) uniforms.resize(count), read_points(*points, first, uniforms);
    const SampleRows rows = out.buffers(count);
    if (one_shot) {
      sample_rounds(s.sampler.one_shot, directions, uniforms, random, rows, s.brdf.batch(), lanes);
    } else {
      sample_rounds(s.sampler.exact, directions, uniforms, random, rows, s.brdf.batch(), NoStatistics{},
                    lanes);
    }
    out.write(first);
  });
}

// Row i of wo has the places [i * n, (i + 1) * n).
void sample_n_into(const PySampler& s, bool one_shot, const Input& wo, std::uint64_t seed,
                   std::uint64_t stream, const Output& wi, const Output& pdf, const Output& weight,
                   const Output& valid) {
  SampleOutput out(s.brdf.f.channels(), width_of(s.brdf), wi, pdf, weight, valid);
  const Rows wo_rows(wo, 3, "wo");
  if (out.size() == 0) return;
  const std::size_t n = out.size() / wo_rows.size();
  Pcg32 random(seed, stream);
  const LaneFunction* lanes = s.brdf.lanes.get();
  in_pieces(wo_rows.size(), 1, [&](std::size_t i, std::size_t) {
    Direction direction;
    read_directions(wo_rows, i, {&direction, 1});
    const SampleRows rows = out.buffers(n);
    if (one_shot) {
      sample_n_rounds(s.sampler.one_shot, direction, random, rows, s.brdf.batch(), lanes);
    } else {
      sample_n_rounds(s.sampler.exact, direction, random, rows, s.brdf.batch(), NoStatistics{}, lanes);
    }
    out.write(i * n);
  });
}

// f, where wanted with the cosine, and the density of a mode, per solid angle; either may be left out.
void eval_pdf_into(const PySampler& s, bool one_shot, const Input& wo, const Input& wi,
                   const std::optional<Output>& f, const std::optional<Output>& pdf, bool cosine) {
  const Rows wo_rows(wo, 3, "wo"), wi_rows(wi, 3, "wi");
  std::optional<Rows> f_rows, pdf_rows;
  if (f) f_rows.emplace(*f, width_of(s.brdf), "out");
  if (pdf) pdf_rows.emplace(*pdf, 0, "out");
  const auto channels = std::size_t(s.brdf.f.channels());
  std::vector<Direction> o, i;
  std::vector<float> values, densities;
  in_pieces(f ? f_rows->size() : pdf_rows->size(), s.brdf.piece(), [&](std::size_t first, std::size_t count) {
    o.resize(count), i.resize(count), values.resize(count * channels), densities.resize(count);
    read_directions(wo_rows, first, o);
    read_directions(wi_rows, first, i);
    if (f || !one_shot) s.brdf.f.eval(o, i, values);
    if (pdf) densities_into(s, one_shot, o, i, values, densities);
    for (std::size_t k = 0; cosine && k < values.size(); ++k) values[k] *= max(i[k / channels].z, 0.f);
    if (f) f_rows->write(first, std::span<const float>(values));
    if (pdf) pdf_rows->write(first, std::span<const float>(densities));
  });
}

template <class Of>
void of_viewer_into(const PySampler& s, const Input& wo, const Output& out, const Of& of) {
  const Rows wo_rows(wo, 3, "wo"), out_rows(out, 0, "out");
  std::vector<Direction> o;
  std::vector<float> values;
  in_pieces(out_rows.size(), s.brdf.piece(), [&](std::size_t first, std::size_t count) {
    o.resize(count), values.resize(count);
    read_directions(wo_rows, first, o);
    for (std::size_t k = 0; k < count; ++k) values[k] = of(o[k]);
    out_rows.write(first, std::span<const float>(values));
  });
}

void invert_into(const PySampler& s, const Input& wo, const Input& wi, const Output& out) {
  const Rows wo_rows(wo, 3, "wo"), wi_rows(wi, 3, "wi"), out_rows(out, 2, "out");
  std::vector<Direction> o, i;
  std::vector<float> values;
  in_pieces(out_rows.size(), s.brdf.piece(), [&](std::size_t first, std::size_t count) {
    o.resize(count), i.resize(count), values.resize(2 * count);
    read_directions(wo_rows, first, o);
    read_directions(wi_rows, first, i);
    for (std::size_t k = 0; k < count; ++k) {
      const auto u = s.sampler.one_shot.invert(o[k], i[k]);
      values[2 * k] = u ? float(u->x) : std::nanf(""), values[2 * k + 1] = u ? float(u->y) : std::nanf("");
    }
    out_rows.write(first, std::span<const float>(values));
  });
}

PySampler build_sampler(const PyBrdf& brdf, const std::string& target, int channel, float expected_trials,
                        float one_shot_variance, float albedo_error, std::uint64_t seed,
                        std::uint64_t max_evaluations, unsigned threads, nb::object progress) {
  const BuildOptions options =
      build_options(target, channel, expected_trials, one_shot_variance, albedo_error, seed, max_evaluations);
  const Host host = make_host(threads, std::move(progress));
  const auto built = [&] {
    const nb::gil_scoped_release no_gil;
    return build(brdf.f, options, host);
  };
  return {brdf, built()};
}

// The leaves of the tree that serves wo: (x, y, width, length, share of the mass) in square coordinates.
std::vector<std::array<float, 5>> leaves_at(const PySampler& s, bool one_shot, Direction wo) {
  const PackedSampler& packed = s.sampler.exact.packed();
  Incidence in;
  if (!find_incidence(packed.viewer, wo, in)) return {};
  const PackedForest& forest = one_shot ? packed.one_shot : packed.exact;
  const PackedSlab& slab = forest.slab_at(in);
  std::vector<std::array<float, 5>> leaves;
  for (std::uint32_t k = 0; k < slab.count; ++k) {
    const PackedLeaf& leaf = forest.leaves[slab.first + k];
    const detail::LeafCell<float> cell = detail::unpack(leaf, packed.domain.half());
    leaves.push_back({cell.x, cell.y, cell.width, cell.length, cell.height * area_of(leaf) / slab.volume});
  }
  return leaves;
}

}  // namespace

void bind_sampler(nb::module_& m) {
  const auto array = [](const char* name) { return nb::arg(name).noconvert(); };
  nb::class_<PySampler>(m, "Sampler", nb::type_slots(Collected<PySampler, owner_of>::slots))
      .def_static("build", &build_sampler, nb::arg("brdf"), nb::kw_only(), nb::arg("target"),
                  nb::arg("channel"), nb::arg("expected_trials"), nb::arg("one_shot_variance"),
                  nb::arg("albedo_error"), nb::arg("seed"), nb::arg("max_evaluations"), nb::arg("threads"),
                  nb::arg("progress").none())
      .def_static(
          "from_bytes",
          [](const PyBrdf& brdf, const nb::bytes& bytes, const std::string& where) {
            const auto* begin = static_cast<const std::uint8_t*>(bytes.data());
            return PySampler(brdf, decode_sampler(Bytes(begin, begin + bytes.size()), where));
          },
          nb::arg("brdf"), nb::arg("bytes"), nb::arg("where"))
      .def_static(
          "from_file",
          [](const PyBrdf& brdf, const std::string& path) { return PySampler(brdf, load_sampler(path)); },
          nb::arg("brdf"), nb::arg("path"))
      .def("to_bytes",
           [](const PySampler& s) {
             const Bytes bytes = encode_sampler(s.data);
             return nb::bytes(bytes.data(), bytes.size());
           })
      .def(
          "save", [](const PySampler& s, const std::string& path) { save_sampler(path, s.data); },
          nb::arg("path"))
      .def("sample", &sample_into, nb::arg("one_shot"), array("wo"), array("u").none(), nb::arg("seed"),
           nb::arg("stream"), array("wi"), array("pdf"), array("weight"), array("valid"))
      .def("sample_n", &sample_n_into, nb::arg("one_shot"), array("wo"), nb::arg("seed"), nb::arg("stream"),
           array("wi"), array("pdf"), array("weight"), array("valid"))
      .def("eval_pdf", &eval_pdf_into, nb::arg("one_shot"), array("wo"), array("wi"), array("f").none(),
           array("pdf").none(), nb::arg("cosine"))
      .def("invert", &invert_into, array("wo"), array("wi"), array("out"))
      .def(
          "albedo",
          [](const PySampler& s, const Input& wo, const Output& out) {
            const float scale = s.data.target.scale;
            of_viewer_into(s, wo, out, [&](Direction w) { return s.sampler.exact.albedo(w) / scale; });
          },
          array("wo"), array("out"))
      .def(
          "expected_trials",
          [](const PySampler& s, const Input& wo, const Output& out) {
            of_viewer_into(s, wo, out, [&](Direction w) { return s.sampler.exact.expected_trials(w); });
          },
          array("wo"), array("out"))
      .def(
          "leaves",
          [](const PySampler& s, bool one_shot, float x, float y, float z) {
            return nb::cast(leaves_at(s, one_shot, {x, y, z}));
          },
          nb::arg("one_shot"), nb::arg("x"), nb::arg("y"), nb::arg("z"))
      .def(
          "tables",
          [](const PySampler& s, bool one_shot) {
            return tables_of(s.sampler.exact.packed(), s.data, one_shot);
          },
          nb::arg("one_shot"))
      .def("draw_one", &draw_one, nb::arg("wo"), nb::arg("u1"), nb::arg("u2"))
      .def("density_one", &density_one, nb::arg("wo"), nb::arg("wi"))
      .def_prop_ro("report", [](const PySampler& s) { return report_of(s.data.report); })
      .def_prop_ro("brdf", [](const PySampler& s) { return s.brdf; })
      .def_prop_ro("material", [](const PySampler& s) { return s.data.material; })
      .def_prop_ro("domain", [](const PySampler& s) { return std::string(name_of(s.data.domain.kind)); })
      .def_prop_ro("half_square", [](const PySampler& s) { return s.data.domain.half(); })
      .def_prop_ro("isotropic", [](const PySampler& s) { return s.data.frame.isotropic(); })
      .def_prop_ro("nbytes", [](const PySampler& s) { return bytes_of(s.sampler.exact.packed()); })
      .def_prop_ro(
          "slabs",
          [](const PySampler& s) { return nb::make_tuple(s.data.exact.size(), s.data.one_shot.size()); })
      .def_prop_ro("leaf_counts", [](const PySampler& s) {
        const PackedSampler& packed = s.sampler.exact.packed();
        return nb::make_tuple(packed.exact.leaves.size(), packed.one_shot.leaves.size());
      });
  m.def(
      "sampler_file_material", [](const std::string& path) { return load_sampler(path).material; },
      nb::arg("path"));
  m.attr("unnamed") = BrdfTraits{}.name;  // the material of a function
}

}  // namespace reflectree::python
