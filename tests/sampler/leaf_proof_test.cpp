// SPDX-License-Identifier: Apache-2.0
// The proof of a leaf may be ended at any time: what it has proved by then is looser, and holds.
#include "../../src/sampler/build/leaf_proof.hpp"

#include <gtest/gtest.h>

#include "functions.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/build.hpp"

namespace reflectree::detail {
namespace {

struct Subject {
  AnyBrdf f = material("ggx:alpha=0.6");
  SamplerData data = build(f);
  PackedSampler packed = pack(data);
  EnclosedField field{f, packed};

  // Of the slab at grazing.
  const PackedSlab& slab() const { return packed.exact.slabs.front(); }
  KnownRange known() const {
    const std::vector<float>& borders = packed.exact.lookup.borders();
    return {borders[0], borders[1]};
  }
  // The largest T / (albedo q) at random points, often at borders.
  double search(const PackedLeaf& leaf, int points) const {
    const ProofBox whole = field.whole(known());
    Pcg32 u(11);
    double largest = 0;
    for (int i = 0; i < points; ++i) {
      const auto share = [&u] { return clamp(1.2 * to_unit_double(u()) - 0.1, 0., 1.); };
      ProofPoint at{linear_mix(std::pow(share(), 0.2), whole.lo[0], whole.hi[0]), share(), share()};
      const PointValue v = field.at(at, known(), leaf);
      if (v.unit > 0) largest = std::max(largest, double(v.target) / double(v.unit));
    }
    return largest;
  }
};

// The twins: what was seen by then, as if the boxes that are left were dropped, and a sharp bound less 0.5 %.
TEST(LeafProof, MayBeEndedAtAnyTime) {
  const Subject s;
  int looser = 0, dropped = 0, cut = 0;
  for (std::uint32_t k = 0; k < s.slab().count; ++k) {
    PackedLeaf leaf = s.packed.exact.leaves[s.slab().first + k];
    leaf.height = 1e-3f;  // nothing is known
    const LeafProof full = prove_leaf(s.field, s.known(), leaf, {0.003, 1.1, 100000});
    ASSERT_TRUE(full.proved);
    const double found = s.search(leaf, 20000);
    EXPECT_LE(found, full.bound);
    cut += found > 0.995 * full.bound;
    for (const std::uint64_t boxes : {100, 300, 2500}) {
      const LeafProof early = prove_leaf(s.field, s.known(), leaf, {0.003, 1e6, boxes});
      EXPECT_LE(early.boxes, boxes + 20);
      dropped += found > 1.001 * early.seen;
      if (!early.proved) continue;
      EXPECT_LE(found, early.bound);
      EXPECT_GE(early.bound, 0.99 * full.bound);
      looser += early.bound > 1.2 * full.bound;
    }
    const LeafProof none = prove_leaf(s.field, s.known(), leaf, {0.003, 1.1, 20});
    EXPECT_FALSE(none.proved) << "what is left needs more than a tenth above what was seen";
  }
  EXPECT_GT(looser, 0) << "or there was nothing to end early";
  EXPECT_GT(dropped, 0);
  EXPECT_GT(cut, 0);
}

// A file may say that a leaf has no height: the proof ends, and says that it is open.
TEST(LeafProof, OfALeafOfNoHeightEnds) {
  const Subject s;
  for (std::uint32_t k = 0; k < s.slab().count; ++k) {
    PackedLeaf leaf = s.packed.exact.leaves[s.slab().first + k];
    leaf.height = 0;
    for (const std::uint64_t boxes : {1, 3000})
      EXPECT_FALSE(prove_leaf(s.field, s.known(), leaf, {0.003, 1e6, boxes}).proved);
  }
}

}  // namespace
}  // namespace reflectree::detail
