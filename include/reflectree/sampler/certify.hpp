// SPDX-License-Identifier: Apache-2.0
// Proves the bounds of a sampler, leaf by leaf, by branch and bound over the leaf's cell and the viewers of its
// slab, on the function's own formula over boxes. What the proof says and assumes: docs/exactness.md.
#pragma once

#include <string>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/family.hpp"
#include "reflectree/host.hpp"
#include "reflectree/sampler/sampler_data.hpp"

namespace reflectree {

struct CertifyOptions {
  // A bound is raised where it exceeds the largest value seen in its leaf by less than this share: what is left
  // to prove then is not sharp. Relative, in (0, 1]. Leaves that take many boxes get twice as much,
  // and twice again, up to a tenth.
  double tolerance = 0.01;
  // Where the boxes are used up, what is proved by then is kept if it exceeds what was seen by no more than this, or by
  // 2 per mille of the slab's trials; in [tolerance, 1].
  double loosest = 1;
  std::uint64_t boxes_per_leaf = 100000;
  // A slab that took no more trials than this before the proof, and would take more after it, has the bounds that
  // gain most proved once more to a quarter of the tolerance, and again, and then leaves halved.
  double trials = 1.25;
};

struct Certification {
  std::size_t slabs = 0, certified_slabs = 0;
  std::size_t leaves = 0, proved_leaves = 0;
  std::size_t raised_leaves = 0;  // of the proved ones: the estimate was below what is proved
  double largest_ratio = 0;       // proved bound over the largest value seen in the leaf
  std::uint64_t boxes = 0;        // that were looked at
};

// Why certify() cannot prove anything about this function, in words; empty where it can.
std::string no_proof(const AnyBrdf& f);
std::string no_proof(const AnyFamily& family);

// Slabs whose leaves are all proved become certified; their bounds rise where they must. A slab with an open
// leaf stays estimated, and a note of the report says how many there are; its bounds rise only where a value
// was seen above them. The result does not depend on the host's threads. Throws Error where no_proof() has an
// answer, for options out of range, and where f returns values that its own enclosure does not hold; Cancelled
// when the host says so: `data` is then as it was.
Certification certify(SamplerData& data, const AnyBrdf& f, const CertifyOptions& options = {},
                      const Host& host = {});
Certification certify(SamplerData& data, const AnyFamily& family, const CertifyOptions& options = {},
                      const Host& host = {});

}  // namespace reflectree
