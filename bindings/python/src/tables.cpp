// SPDX-License-Identifier: Apache-2.0
// The run-time arrays of a sampler as bytes, for whoever samples from them in an array language of his own; and one
// direction at a time without its value, for whoever has values of his own.
#include <nanobind/stl/string.h>

#include "sampler.hpp"

namespace reflectree::python {

namespace {

template <class T>
nb::bytes bytes_of(const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return nb::bytes(values.data(), values.size() * sizeof(T));
}

}  // namespace

// reflectree/_tables.py knows the layouts. Of anisotropic functions and families slabs are found by the
// partition, of all others by `borders`, cosines that ascend.
nb::dict tables_of(const PackedSampler& packed, const SamplerData& data, bool one_shot) {
  const PackedForest& forest = one_shot ? packed.one_shot : packed.exact;
  const Partition& partition = one_shot ? data.one_shot_partition : data.exact_partition;
  const PackedViewer& viewer = packed.viewer;
  const PackedFamily& family = viewer.family;
  const bool by_cosine = viewer.frame.isotropic() && family.count == 0;
  nb::dict d;
  d["domain"] = name_of(packed.domain.kind);
  d["half"] = packed.domain.half();
  d["exponent"] = packed.domain.exponent;
  d["stretch"] = packed.domain.stretch;
  d["symmetry"] = name_of(viewer.frame.symmetry);
  d["cos_axis"] = viewer.cos_axis;
  d["sin_axis"] = viewer.sin_axis;
  d["turns"] = viewer.turns;
  d["scale"] = packed.target.scale;
  d["borders"] = bytes_of(by_cosine ? forest.lookup.borders() : std::vector<float>());
  d["partition_axis"] = bytes_of(partition.axis);
  d["partition_split"] = bytes_of(partition.split);
  d["slabs"] = bytes_of(forest.slabs);
  d["leaves"] = bytes_of(forest.leaves);
  d["nodes"] = bytes_of(forest.nodes);
  d["albedo_borders"] = bytes_of(viewer.albedo.lookup.borders());
  d["albedo_pieces"] = bytes_of(viewer.albedo.pieces);
  d["albedo_segments"] = bytes_of(viewer.albedo.segments);
  nb::list parameters, widths, axes;
  for (std::size_t i = 0; i < family.count; ++i) {
    const PackedParameter& p = family.parameters[i];
    parameters.append(
        nb::make_tuple(data.parameters[i].range.name, p.lo, p.hi, p.lowest, p.highest, p.logarithmic));
  }
  for (const PackedWidth* w : {&family.x, &family.y})
    widths.append(nb::make_tuple(w->largest, nb::make_tuple(w->slope[0], w->slope[1]),
                                 nb::make_tuple(w->corner[0], w->corner[1])));
  for (const PackedAlbedo::Axis& a : viewer.albedo.parameters)
    axes.append(nb::make_tuple(a.lo, a.rows_per_unit, a.rows, a.stride));
  d["parameters"] = parameters;
  d["widths"] = widths;
  d["albedo_axes"] = axes;
  d["albedo_row"] = viewer.albedo.row;
  return d;
}

namespace {

// One-shot mode of the same tables, with nothing to evaluate. The packed form stays that of `s`.
OneShotSampler<float (*)(Direction, Direction)> without_values(const PySampler& s) {
  return {[](Direction, Direction) { return 0.f; },
          std::shared_ptr<const PackedSampler>(std::shared_ptr<void>(), &s.sampler.one_shot.packed())};
}

}  // namespace

std::array<float, 4> draw_one(const PySampler& s, const std::array<float, 3>& wo, double u1, double u2) {
  const auto drawn = without_values(s).sample(Direction{wo[0], wo[1], wo[2]}, u1, u2);
  if (!drawn) return {0, 0, 1, 0};
  return {drawn->wi.x, drawn->wi.y, drawn->wi.z, drawn->pdf};
}

float density_one(const PySampler& s, const std::array<float, 3>& wo, const std::array<float, 3>& wi) {
  return s.sampler.one_shot.pdf({wo[0], wo[1], wo[2]}, {wi[0], wi[1], wi[2]});
}

}  // namespace reflectree::python
