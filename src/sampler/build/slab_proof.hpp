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
  CanonicalTree tree;             // nodes and slopes, which grow where a leaf is halved; masses are the build's

  bool proved() const;
  // Expected trials with the bounds that the build left, and with those that were proved.
  double trials_before() const, trials() const;
};

// Halves leaves of a proved slab that takes more than `trials`, those first whose bound rose most: where the build saw
// too little of a leaf, one bound is too coarse for it. Halves keep the shape of their leaf. Stops where no half
// is better than the whole.
void halve_leaves(SlabProof& slab, double trials, const EnclosedField& field, const ProofLimits& limits);

}  // namespace reflectree::detail
