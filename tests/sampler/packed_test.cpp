// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "functions.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree {
namespace {

struct Made {
  SamplerData data;
  PackedSampler packed;
};
const Made& made() {
  static const Made m = [] {
    SamplerData data = build(material("ggx:alpha=0.2"));
    PackedSampler packed = pack(data);
    return Made{std::move(data), std::move(packed)};
  }();
  return m;
}

// Slabs of the packed form ascend in the cosine, those of the canonical form in theta_o.
template <class Visit>
void for_each_slab(const PackedForest& forest, std::size_t trees, Visit&& visit) {
  ASSERT_EQ(forest.slabs.size(), trees);
  for (std::size_t s = 0; s < trees; ++s) visit(s, forest.slabs[trees - 1 - s]);
}

// The probability of every leaf, summed over its own and the aliased buckets, is its mass exactly; one
// leaf takes up what is missing to a multiple of the count.
TEST(Pack, AliasTablesAreExactInIntegers) {
  const auto check = [](const PackedForest& forest, const PackedSlab& slab, const CanonicalTree& tree) {
    ASSERT_EQ(slab.count, tree.mass.size());
    const PackedLeaf* leaves = forest.leaves.data() + slab.first;
    std::vector<std::uint64_t> probability(slab.count);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < slab.count; ++i) {
      ASSERT_LE(leaves[i].threshold, slab.bucket);
      ASSERT_LT(leaves[i].alias, slab.count);
      probability[i] += leaves[i].threshold;
      probability[leaves[i].alias] += slab.bucket - leaves[i].threshold;
      sum += tree.mass[i];
    }
    const std::uint64_t missing = std::uint64_t(slab.bucket) * slab.count - sum;
    EXPECT_LT(missing, slab.count);
    std::size_t raised = 0;
    for (std::size_t i = 0; i < slab.count; ++i) {
      if (probability[i] == tree.mass[i]) continue;
      ++raised;
      EXPECT_EQ(probability[i], tree.mass[i] + missing);
    }
    EXPECT_LE(raised, 1u);
  };
  const PackedSampler& packed = made().packed;
  const SamplerData& data = made().data;
  for_each_slab(packed.exact, data.exact.size(),
                [&](std::size_t s, const PackedSlab& slab) { check(packed.exact, slab, data.exact[s]); });
  for_each_slab(packed.one_shot, data.one_shot.size(), [&](std::size_t s, const PackedSlab& slab) {
    check(packed.one_shot, slab, data.one_shot[s]);
  });
}

TEST(Pack, MajorantsFollowFromTheMassAndNeverFallShort) {
  const Domain& domain = made().data.domain;
  for_each_slab(made().packed.exact, made().data.exact.size(), [&](std::size_t s, const PackedSlab& slab) {
    const MajorantTree& tree = made().data.exact[s];
    const auto cells = leaf_cells(tree.nodes, domain.symmetry);
    double sum = 0, volume = 0;
    for (const std::uint32_t m : tree.mass) sum += m;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const PackedLeaf& leaf = made().packed.exact.leaves[slab.first + i];
      const Vec2<float> first = detail::point_at(leaf, domain.half(), 0, 0).p;
      const Vec2<float> last = detail::point_at(leaf, domain.half(), 1, 1).p;
      EXPECT_EQ(first, (Vec2<float>{cells[i].x0, cells[i].y0}));
      EXPECT_EQ(last, (Vec2<float>{cells[i].x1, cells[i].y1}));
      const double share = double(last.x - first.x) * double(last.y - first.y) / (domain.half() ? 2 : 4);
      EXPECT_EQ(double(area_of(leaf)), share);
      const double wanted = double(tree.volume) * tree.mass[i] / sum / share;
      EXPECT_GE(double(leaf.height), wanted * (1 - 1e-7));  // a rounding of float
      EXPECT_LE(double(leaf.height), wanted * (1 + 1e-3));
      volume += double(leaf.height) * share;
    }
    EXPECT_NEAR(volume / double(slab.volume), 1, 1e-6);
    EXPECT_NEAR(double(slab.volume / tree.volume), 1, 1e-5);
  });
}

// Corner and width of every cell that there is, of whole squares and of halves.
TEST(Pack, CellsComeBackFromTheirMiddles) {
  for (int level = 0; level <= 15; ++level) {
    for (int k = 0; k < 1 << level; ++k) {
      PackedLeaf leaf;
      leaf.x = leaf.y = std::uint16_t((2 * k + 1) << (15 - level));
      const float width = std::ldexp(2.f, -level), start = float(k) * width;
      for (const bool half : {false, true}) {
        const detail::LeafCell<float> cell = detail::unpack(leaf, half);
        ASSERT_TRUE(cell.x == start - 1 && cell.width == width) << level << ' ' << k;
        ASSERT_EQ(cell.y, half ? 0.5f * start : start - 1) << level << ' ' << k;
        ASSERT_EQ(cell.length, half ? 0.5f * width : width) << level << ' ' << k;
      }
      ASSERT_EQ(area_of(leaf), std::ldexp(1.f, -2 * level));
    }
  }
}

// E[1 / height] over points drawn in proportion to the height is 1 / its mean, in both ways to draw.
TEST(Pack, PointsOfALeafAreDrawnFromItsShape) {
  const PackedForest& forest = made().packed.exact;
  const PackedSlab& slab = forest.slabs[forest.slabs.size() / 2];
  const bool half = made().packed.domain.half();
  Pcg32 u(1);
  for (std::uint32_t i = 0; i < slab.count; i += 3) {
    const PackedLeaf& leaf = forest.leaves[slab.first + i];
    if (std::abs(int(leaf.slope_x)) > 115 || std::abs(int(leaf.slope_y)) > 115) continue;  // 1 / 0 at an edge
    double inverse = 0, by_bits = 0;
    const int n = 1 << 14;
    for (int k = 0; k < n; ++k) {
      const float ux = (float(k % 128) + 0.5f) / 128, uy = (float(k / 128) + 0.5f) / 128;
      inverse += double(leaf.height / detail::place(leaf, half, ux, uy).height) / n;
      bool coin = false;
      by_bits += double(leaf.height / detail::place({leaf, detail::bits64(u)}, half, u, coin).height) / n;
    }
    EXPECT_NEAR(inverse, 1, 0.02) << int(leaf.slope_x) << ' ' << int(leaf.slope_y);
    EXPECT_NEAR(by_bits, 1, 0.06) << int(leaf.slope_x) << ' ' << int(leaf.slope_y);
  }
}

TEST(Pack, CountsItsBytes) {
  const PackedSampler& p = made().packed;
  const std::size_t least = (p.exact.leaves.size() + p.one_shot.leaves.size()) * sizeof(PackedLeaf);
  EXPECT_GT(bytes_of(p), least);
  EXPECT_LT(bytes_of(p), 2 * least + 40'000);
}

TEST(CosineLookup, AgreesWithBinarySearchAtRandomAndAtBorders) {
  Pcg32 u(5);
  for (const int count : {1, 2, 7, 100, 3000}) {
    std::vector<float> borders{min_cos_theta_o, 1};
    // Half of them evenly, half crowded at the horizon.
    while (int(borders.size()) < count + 1) {
      const float x = to_unit_float(u());
      borders.push_back(u() % 2 ? max(x, 2 * min_cos_theta_o) : pow(min_cos_theta_o, 0.99f * x));
    }
    std::sort(borders.begin(), borders.end());
    borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
    const CosineLookup lookup(borders);
    const auto wanted = [&](float c) {
      const auto i = std::upper_bound(borders.begin(), borders.end(), c) - borders.begin() - 1;
      return std::min(std::size_t(i), borders.size() - 2);
    };
    const auto check = [&](float c) {
      if (c >= min_cos_theta_o && c <= 1) {
        EXPECT_EQ(lookup(c), wanted(c)) << c;
      }
    };
    for (int i = 0; i < 20'000; ++i) {
      check(to_unit_float(u()));
      check(pow(min_cos_theta_o, to_unit_float(u())));
    }
    for (const float b : borders) {
      check(b);
      check(std::nextafter(b, 0.f));
      check(std::nextafter(b, 2.f));
    }
  }
}

}  // namespace
}  // namespace reflectree
