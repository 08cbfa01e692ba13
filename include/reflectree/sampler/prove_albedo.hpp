// SPDX-License-Identifier: Apache-2.0
// Proves how far the stored albedo, by which pdf and weight of exact mode are normalised, may be off: for every
// viewer, by integrals of affine forms. What the proof says and assumes: docs/exactness.md.
#pragma once

#include "reflectree/sampler/certify.hpp"

namespace reflectree {

struct AlbedoProofOptions {
  // What is to be proved; in (0, 1). The boxes grow with its power of -1.5.
  double relative_error = 0.02;
  // That may be looked at for a slab, in all passes.
  std::uint64_t boxes_per_slab = 8000000;
};

struct AlbedoProof {
  // |table - albedo| / albedo is at most this for every viewer up to 89.9 degrees, and ten times it beyond;
  // infinite where boxes did not suffice to tell anything.
  double relative_error = 0;
  std::uint64_t boxes = 0;  // that were looked at
};

// Writes what is proved into the table, where that is below 1; also where it is more than was asked for. Does
// not depend on the host's threads. Throws Error where no_proof() has an answer and for options out of range;
// Cancelled when the host says so: `data` is then as it was.
AlbedoProof prove_albedo(SamplerData& data, const AnyBrdf& f, const AlbedoProofOptions& options = {},
                         const Host& host = {});

}  // namespace reflectree
