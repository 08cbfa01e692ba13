// SPDX-License-Identifier: Apache-2.0
// A slab whose bounds are being proved, with its leaves as they are sampled.
#pragma once

#include <vector>

#include "leaf_proof.hpp"

namespace reflectree::detail {

struct SlabProof {
  KnownRange known;
  std::vector<PackedLeaf> leaves;
  std::vector<LeafProof> proofs;  // of each leaf
  CanonicalTree tree;  // nodes and slopes, which grow where a leaf is halved; masses are the build's

  bool proved() const;
  // Of leaf k: what is proved, or in a slab with open leaves what holds at least what was seen; none is lowered there.
  double bound(std::size_t k) const;
  // Expected trials with the bounds that the build left, and with these.
  double trials_before() const, trials() const;
};

// Halves leaves of a slab that takes more than `trials`, those first that promise to gain most: where the build saw too
// little of a leaf, one bound is too coarse for it, and elsewhere others pay. Halves keep the shape of their leaf and
// are proved. Stops where it is enough, where nothing is gained, and at an eighth more leaves.
void halve_leaves(SlabProof& slab, double trials, const EnclosedField& field, const ProofLimits& limits);

}  // namespace reflectree::detail
