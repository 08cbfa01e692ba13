// SPDX-License-Identifier: Apache-2.0
// Packed against canonical: nothing that samples may differ from what was built.
#include "reflectree/verify/packing.hpp"

#include "suspects.hpp"

namespace reflectree {
namespace {

PackedSampler packed() { return pack(built().data); }
std::vector<CheckResult> judge(const PackedSampler& p) { return check_packing(built().data, p); }

TEST(Packing, IsFaithful) {
  const auto results = judge(packed());
  EXPECT_EQ(results.size(), 5u);
  expect_all_pass(results);
}

TEST(PackingTwin, OneNodeOfTheAlbedo) {
  PackedSampler p = packed();
  AlbedoPiece& piece = p.viewer.albedo.pieces[p.viewer.albedo.pieces.size() / 2];
  piece.base *= 1.003f, piece.slope *= 1.003f;
  EXPECT_TRUE(fails(judge(p), "packed_albedo"));
}

TEST(PackingTwin, SlabsAndTheirBorders) {
  PackedSampler p = packed();
  std::vector<float> borders = p.one_shot.lookup.borders();
  ASSERT_GT(borders.size(), 3u);
  borders[borders.size() / 2] *= 1.0005f;
  p.one_shot.lookup = CosineLookup(borders);
  EXPECT_TRUE(fails(judge(p), "packed_slabs"));
  p = packed();
  p.exact.slabs.pop_back();
  EXPECT_TRUE(fails(judge(p), "packed_slabs"));
}

TEST(PackingTwin, Leaves) {
  const auto spoilt = [](const std::function<void(PackedLeaf&)>& spoil, std::size_t at) {
    PackedSampler p = packed();
    spoil(p.exact.leaves[at]);
    return judge(p);
  };
  EXPECT_TRUE(fails(spoilt([](PackedLeaf& l) { l.height *= 1.00001f; }, 3), "packed_leaves"));
  EXPECT_TRUE(
      fails(spoilt([](PackedLeaf& l) { l.slope_y = std::int8_t(l.slope_y + 1); }, 3), "packed_leaves"));
  const auto a_cell_on = [](PackedLeaf& l) { l.x = std::uint16_t(l.x + 2 * half_width(l.x)); };
  EXPECT_TRUE(fails(spoilt(a_cell_on, 3), "packed_leaves"));
  const auto half_as_wide = [](PackedLeaf& l) { l.y = std::uint16_t(l.y - half_width(l.y) / 2); };
  EXPECT_TRUE(fails(spoilt(half_as_wide, 3), "packed_leaves"));
}

TEST(PackingTwin, AUnitOfAnAliasTable) {
  PackedSampler p = packed();
  for (PackedLeaf& l : p.one_shot.leaves) {
    if (l.threshold == 0) continue;
    --l.threshold;
    break;
  }
  EXPECT_TRUE(fails(judge(p), "packed_choice"));
}

TEST(PackingTwin, LowerSharesOfTheDescent) {
  PackedSampler p = packed();
  ASSERT_FALSE(p.one_shot.nodes.empty());
  p.one_shot.nodes.back().lower *= 0.99f;
  EXPECT_TRUE(fails(judge(p), "packed_descent"));
}

}  // namespace
}  // namespace reflectree
