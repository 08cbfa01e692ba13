// SPDX-License-Identifier: Apache-2.0
// The proof of one leaf's bound by branch and bound.
#pragma once

#include <cstdint>

#include "enclosed_field.hpp"

namespace reflectree::detail {

struct ProofLimits {
  double tolerance;     // a bound may exceed the largest value seen by this share
  double loosest;       // and by this one, where the boxes are used up
  std::uint64_t boxes;  // that may be looked at
};

// Of T / (albedo q) over the leaf and the viewers of its slab.
struct LeafProof {
  bool proved = false;
  double bound = 0;  // at least the leaf's own; proved, if it is
  double seen = 0;   // the largest value that floats showed
  std::uint64_t boxes = 0;
};

// Throws Error where a value that f returns lies outside of what its enclosure says.
LeafProof prove_leaf(const EnclosedField& field, const KnownRange& known, const PackedLeaf& leaf,
                     const ProofLimits& limits);

}  // namespace reflectree::detail
