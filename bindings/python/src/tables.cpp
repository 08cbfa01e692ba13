// SPDX-License-Identifier: Apache-2.0
// The run-time arrays of a sampler as bytes, for whoever samples from them in an array language of his own; and one
// direction at a time without its value, for whoever has values of his own.
#include "sampler.hpp"

namespace reflectree::python {

namespace {

template <class T>
nb::bytes bytes_of(const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return nb::bytes(values.data(), values.size() * sizeof(T));
}

}  // namespace

// reflectree/_tables.py knows the layouts. Of anisotropic functions slabs are found by the partition, of all
// others by `borders`, cosines that ascend.
nb::dict tables_of(const PySampler& s, bool one_shot) {
  const PackedSampler& packed = s.sampler.exact.packed();
  const PackedForest& forest = one_shot ? packed.one_shot : packed.exact;
  const Partition& partition = one_shot ? s.data.one_shot_partition : s.data.exact_partition;
  const PackedViewer& viewer = packed.viewer;
  const bool isotropic = viewer.frame.isotropic();
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
  d["borders"] = bytes_of(isotropic ? forest.lookup.borders() : std::vector<float>());
  d["partition_axis"] = bytes_of(partition.axis);
  d["partition_split"] = bytes_of(partition.split);
  d["slabs"] = bytes_of(forest.slabs);
  d["leaves"] = bytes_of(forest.leaves);
  d["nodes"] = bytes_of(forest.nodes);
  d["albedo_borders"] = bytes_of(viewer.albedo.lookup.borders());
  d["albedo_pieces"] = bytes_of(viewer.albedo.pieces);
  d["albedo_segments"] = bytes_of(viewer.albedo.segments);
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
