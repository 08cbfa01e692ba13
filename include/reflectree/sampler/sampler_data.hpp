// SPDX-License-Identifier: Apache-2.0
// The canonical form of a sampler: plain immutable data, what is saved, drawn, compared and fuzzed.
// The packed form that samples quickly is made from it at load (packed_sampler.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "reflectree/brdf/target.hpp"
#include "reflectree/math/direction.hpp"
#include "reflectree/sampler/domain.hpp"
#include "reflectree/sampler/partition.hpp"

namespace reflectree {

// What the bounds of a slab rest on.
enum class BoundStatus : std::uint8_t { certified, estimated };

// A node of a tree over the square, in preorder; the lower half comes first.
enum class TreeSplit : std::uint8_t { leaf = 0, x = 1, y = 2 };

// A tree of one slab. Leaf i is chosen with probability mass_i / sum(mass); across it, for s, t in [-1, 1],
// runs the product-linear shape q = (1 + gx s)(1 + gy t), gx = slope_x / 128 in (-1, 1), whose mean is 1.
struct CanonicalTree {
  std::vector<TreeSplit> nodes;
  std::vector<std::uint32_t> mass;  // of each leaf, in preorder
  std::vector<std::int8_t> slope_x, slope_y;
  friend bool operator==(const CanonicalTree&, const CanonicalTree&) = default;
};

// Exact mode: leaf i bounds the normalised target, T / albedo <= majorant_i q, where
// majorant_i = volume * (mass_i / sum(mass)) / area_i and area is the leaf's share of the square. The bound
// is derived from the integer mass, so that rounding costs trials and never exactness. volume = expected
// trials where the albedo is exact.
struct MajorantTree : CanonicalTree {
  float volume = 0;
  BoundStatus status = BoundStatus::estimated;
  friend bool operator==(const MajorantTree&, const MajorantTree&) = default;
};

// One-shot mode: the density per share of the square is (mass_i / sum(mass)) / area_i q.
struct DensityTree : CanonicalTree {
  friend bool operator==(const DensityTree&, const DensityTree&) = default;
};

// a(wo) = integral of t cos_i over the hemisphere, piecewise linear in cos_theta_o.
struct AlbedoTable {
  std::vector<float> cos_theta_o;  // ascending, from the smallest served to 1
  std::vector<float> albedo;
  // Stated bound on the error of quadrature and interpolation up to 89.9 degrees; beyond, ten times as large.
  float relative_error = 0;
  friend bool operator==(const AlbedoTable&, const AlbedoTable&) = default;
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
  Domain domain;
  Partition exact_partition;
  std::vector<MajorantTree> exact;  // one a slab
  Partition one_shot_partition;
  std::vector<DensityTree> one_shot;
  AlbedoTable albedo;
  BrdfProbes probes;
  BuildReport report;
  friend bool operator==(const SamplerData&, const SamplerData&) = default;
};

// Throws Error unless every tree is complete, every number finite and in range.
void validate(const SamplerData& data);

// A leaf's box in square coordinates.
struct SquareCell {
  float x0, x1, y0, y1;
};
// The cells of all leaves of a tree in preorder; the root is the domain's square.
std::vector<SquareCell> leaf_cells(const std::vector<TreeSplit>& nodes, const Domain& domain);

}  // namespace reflectree
