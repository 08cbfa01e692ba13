// SPDX-License-Identifier: Apache-2.0
#include "slab_proof.hpp"

#include <algorithm>

#include "leaf.hpp"

namespace reflectree::detail {

namespace {

struct Halves {
  std::array<PackedLeaf, 2> leaves;
  std::array<LeafProof, 2> proofs;
  TreeSplit split = TreeSplit::leaf;  // none
  double volume = 0;
};

// With s = (s' -+ 1) / 2 the shape 1 + g s is (1 -+ g / 2) (1 + g / (2 -+ g) s').
PackedLeaf half_of(const PackedLeaf& leaf, TreeSplit split, bool upper) {
  PackedLeaf half = leaf;
  const bool along_x = split == TreeSplit::x;
  std::uint16_t& middle = along_x ? half.x : half.y;
  std::int8_t& slope = along_x ? half.slope_x : half.slope_y;
  const std::uint32_t quarter = half_width(middle) / 2;
  middle = std::uint16_t(upper ? middle + quarter : middle - quarter);
  const double g = double(slope) / 128, sign = upper ? 1 : -1;
  slope = std::int8_t(std::clamp(std::lround(128 * g / (2 + sign * g)), -127L, 127L));
  half.height = float(double(leaf.height) * (1 + 0.5 * sign * g));
  return half;
}

// What halving a leaf would take off its volume, as values at points of both halves and at viewers of the slab say.
struct Promise {
  double gain = 0;
  TreeSplit split = TreeSplit::leaf;  // none
};
Promise promise_of(const SlabProof& slab, std::size_t k, const EnclosedField& field) {
  constexpr int across = 5, viewers = 3;
  const PackedLeaf& leaf = slab.leaves[k];
  const ProofBox whole = field.whole(slab.known);
  const auto is_place = [](std::size_t axis) { return axis == 1 || axis == 2; };
  int count = 1;
  for (std::size_t axis = 0; axis < field.axes(); ++axis) count *= is_place(axis) ? across : viewers;
  double most[2][2] = {{floor_share, floor_share}, {floor_share, floor_share}};  // of each way both halves
  for (int i = 0; i < count; ++i) {
    ProofPoint at{};
    for (std::size_t axis = 0, rest = std::size_t(i); axis < field.axes(); ++axis) {
      const std::size_t n = is_place(axis) ? across : viewers;
      at[axis] = linear_mix(double(rest % n) / double(n - 1), whole.lo[axis], whole.hi[axis]);
      rest /= n;
    }
    const PointValue value = field.at(at, slab.known, leaf);
    if (!(value.unit > 0)) continue;
    for (std::size_t way = 0; way < 2; ++way) {
      const double share = double(value.target) / double(value.unit);
      if (at[1 + way] <= 0.5) most[way][0] = std::max(most[way][0], share);
      if (at[1 + way] >= 0.5) most[way][1] = std::max(most[way][1], share);
    }
  }
  Promise best;
  for (std::size_t way = 0; way < 2; ++way) {
    if (half_width(way == 0 ? leaf.x : leaf.y) < 2) continue;  // as small as cells get
    const double g = double(way == 0 ? leaf.slope_x : leaf.slope_y) / 128;
    const double mean = 0.5 * ((1 - 0.5 * g) * most[way][0] + (1 + 0.5 * g) * most[way][1]);
    const double gain = double(area_of(leaf)) * (slab.bound(k) - mean);
    if (gain > best.gain) best = {gain, way == 0 ? TreeSplit::x : TreeSplit::y};
  }
  return best;
}

// Both halves with their bounds; of none, where one is open.
Halves halved(const SlabProof& slab, std::size_t k, TreeSplit split, const EnclosedField& field,
              const ProofLimits& limits) {
  Halves out;
  for (const bool upper : {false, true}) {
    PackedLeaf half = half_of(slab.leaves[k], split, upper);
    half.height = floor_share;  // the whole leaf's bound says little of a half
    const LeafProof proof = prove_leaf(field, slab.known, half, limits);
    if (!proof.proved) return {};
    half.height = float(proof.bound);
    out.leaves[upper] = half, out.proofs[upper] = proof;
    out.volume += double(area_of(half)) * proof.bound;
  }
  out.split = split;
  return out;
}

void replace(SlabProof& slab, std::size_t k, const Halves& halves) {
  const auto at = std::ptrdiff_t(k);
  slab.leaves[k] = halves.leaves[0], slab.proofs[k] = halves.proofs[0];
  slab.leaves.insert(slab.leaves.begin() + at + 1, halves.leaves[1]);
  slab.proofs.insert(slab.proofs.begin() + at + 1, halves.proofs[1]);
  CanonicalTree& tree = slab.tree;
  tree.slope_x[k] = halves.leaves[0].slope_x, tree.slope_y[k] = halves.leaves[0].slope_y;
  tree.slope_x.insert(tree.slope_x.begin() + at + 1, halves.leaves[1].slope_x);
  tree.slope_y.insert(tree.slope_y.begin() + at + 1, halves.leaves[1].slope_y);
  std::size_t node = 0;
  for (std::size_t leaf = 0;; ++node) {
    if (tree.nodes[node] == TreeSplit::leaf && leaf++ == k) break;
  }
  tree.nodes[node] = halves.split;
  tree.nodes.insert(tree.nodes.begin() + std::ptrdiff_t(node) + 1, 2, TreeSplit::leaf);
}

}  // namespace

bool SlabProof::proved() const {
  return std::all_of(proofs.begin(), proofs.end(), [](const LeafProof& p) { return p.proved; });
}
double SlabProof::trials_before() const {
  double sum = 0;
  for (const PackedLeaf& leaf : leaves) sum += double(area_of(leaf)) * double(leaf.height);
  return sum;
}
double SlabProof::bound(std::size_t k) const {
  const double height = double(leaves[k].height), seen = proofs[k].seen;
  if (proved()) return proofs[k].bound;
  return std::max(height, seen * (seen > height ? 1.001 : 1));
}
double SlabProof::trials() const {
  double sum = 0;
  for (std::size_t k = 0; k < leaves.size(); ++k) sum += double(area_of(leaves[k])) * bound(k);
  return sum;
}

void halve_leaves(SlabProof& slab, double trials, const EnclosedField& field, const ProofLimits& limits) {
  if (slab.trials() <= trials) return;
  std::vector<Promise> promises;
  for (std::size_t k = 0; k < slab.leaves.size(); ++k) promises.push_back(promise_of(slab, k, field));
  const std::size_t most = slab.leaves.size() + 16 + slab.leaves.size() / 8;
  while (slab.leaves.size() < most && slab.trials() > trials) {
    const auto best = std::max_element(promises.begin(), promises.end(),
                                       [](const Promise& a, const Promise& b) { return a.gain < b.gain; });
    if (best->split == TreeSplit::leaf) return;
    const auto k = std::size_t(best - promises.begin());
    const Halves halves = halved(slab, k, best->split, field, limits);
    const double whole = double(area_of(slab.leaves[k])) * slab.bound(k);
    if (halves.split == TreeSplit::leaf || halves.volume >= whole) {
      *best = {};
      continue;
    }
    replace(slab, k, halves);
    *best = promise_of(slab, k, field);
    promises.insert(promises.begin() + std::ptrdiff_t(k) + 1, promise_of(slab, k + 1, field));
  }
}

}  // namespace reflectree::detail
