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

// The better of the two ways to halve a leaf, if both of its halves are proved.
Halves halved(const SlabProof& slab, std::size_t k, const EnclosedField& field, const ProofLimits& limits) {
  const PackedLeaf& leaf = slab.leaves[k];
  Halves best;
  best.volume = double(area_of(leaf)) * slab.proofs[k].bound;
  for (const TreeSplit split : {TreeSplit::x, TreeSplit::y}) {
    if (half_width(split == TreeSplit::x ? leaf.x : leaf.y) < 2) continue;  // as small as cells get
    Halves tried;
    tried.split = split;
    bool proved = true;
    for (const bool upper : {false, true}) {
      const PackedLeaf half = half_of(leaf, split, upper);
      PackedLeaf low = half;  // the whole leaf's bound says little of a half
      low.height = floor_share;
      const LeafProof proof = prove_leaf(field, slab.known, low, limits);
      proved = proved && proof.proved;
      tried.leaves[upper] = half, tried.proofs[upper] = proof;
      tried.volume += double(area_of(half)) * proof.bound;
    }
    if (proved && tried.volume < best.volume) best = tried;
  }
  return best;
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
double SlabProof::trials() const {
  double sum = 0;
  for (std::size_t k = 0; k < leaves.size(); ++k) sum += double(area_of(leaves[k])) * proofs[k].bound;
  return sum;
}

void halve_leaves(SlabProof& slab, double trials, const EnclosedField& field, const ProofLimits& limits) {
  constexpr int most = 16;  // halvings of one slab
  for (int i = 0; i < most && slab.trials() > trials; ++i) {
    std::size_t worst = 0;
    double most_raised = -1;
    for (std::size_t k = 0; k < slab.leaves.size(); ++k) {
      const double raised =
          double(area_of(slab.leaves[k])) * (slab.proofs[k].bound - double(slab.leaves[k].height));
      if (raised > most_raised) most_raised = raised, worst = k;
    }
    const Halves halves = halved(slab, worst, field, limits);
    if (halves.split == TreeSplit::leaf) return;
    replace(slab, worst, halves);
  }
}

}  // namespace reflectree::detail
