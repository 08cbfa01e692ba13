// SPDX-License-Identifier: Apache-2.0
// The canonical form of a sampler: plain immutable data, what is saved, drawn, compared and fuzzed.
// The packed form that samples quickly is made from it at load (packed_sampler.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "reflectree/brdf/target.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/sampler/known/parameter.hpp"
#include "reflectree/sampler/known/partition.hpp"
#include "reflectree/sampler/known/viewer_frame.hpp"
#include "reflectree/sampler/square/domain.hpp"
#include "reflectree/sampler/square/tree.hpp"

namespace reflectree {

// What the bounds of a slab rest on.
enum class BoundStatus : std::uint8_t { certified, estimated };

// Exact mode: leaf i bounds the normalised target, T / albedo <= majorant_i q, where
// majorant_i = volume * (mass_i / sum(mass)) / area_i and area is the leaf's share of the square. The bound
// is derived from the integer mass, so that rounding costs trials and never exactness. volume = expected
// trials where the albedo is exact.
struct MajorantTree : CanonicalTree {
  float volume = 0;
  BoundStatus status = BoundStatus::estimated;
  // Of certified bounds the largest share by which one exceeds the largest value seen in its leaf, as a ratio;
  // 0: not certified.
  float bound_ratio = 0;
  friend bool operator==(const MajorantTree&, const MajorantTree&) = default;
};

// One-shot mode: the density per share of the square is (mass_i / sum(mass)) / area_i q.
struct DensityTree : CanonicalTree {
  friend bool operator==(const DensityTree&, const DensityTree&) = default;
};

// Identity of the BRDF: its target at fixed pairs, compared with a tolerance at load.
struct BrdfProbes {
  static constexpr std::size_t count = 64;
  std::array<float, count> target{};
  // Of functions without a name also every channel, pair after pair: a name says which channels are meant.
  std::vector<float> channels;
  friend bool operator==(const BrdfProbes&, const BrdfProbes&) = default;
};

// What the builder measured about its own bounds.
struct BuildReport {
  float expected_trials = 0;    // worst slab
  float overshoot_mass = 0;     // estimate of 1 - int min(T, aM) / int T, worst slab
  float one_shot_variance = 0;  // median over slabs of the relative variance
  float asymmetry = 0;          // mean |T - mirrored T| / mean T
  std::uint64_t evaluations = 0;
  // What was promised and is not kept, where, and what to do: a sentence each; none as a rule.
  std::vector<std::string> notes;
  friend bool operator==(const BuildReport&, const BuildReport&) = default;
};

struct SamplerData {
  std::string material;  // canonical text of the BRDF, for people
  Target target;
  ViewerFrame frame;
  Domain domain;
  std::vector<KnownParameter> parameters;  // of families
  ScaleLaw law;                            // of families: of the domain's widths
  Partition exact_partition;
  std::vector<MajorantTree> exact;  // one per slab
  Partition one_shot_partition;
  std::vector<DensityTree> one_shot;
  AlbedoTable albedo;
  BrdfProbes probes;
  BuildReport report;
  friend bool operator==(const SamplerData&, const SamplerData&) = default;
};

// Throws Error unless every tree is complete, every number finite and in range.
void validate(const SamplerData& data);

}  // namespace reflectree
