// SPDX-License-Identifier: Apache-2.0
// The run-time arrays of a sampler as bytes, for whoever samples from them in an array language of his own.
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

}  // namespace reflectree::python
