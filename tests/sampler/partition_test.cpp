// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/partition.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "reflectree/error.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

constexpr std::uint8_t leaf = Partition::leaf;

// A random tree over two coordinates; every split cuts its box at a random share.
Partition random_partition(std::uint64_t seed) {
  Partition p;
  p.coordinates = {{"theta_o", 0, 1.5f}, {"alpha", -2, 3}};
  Pcg32 u(seed);
  const std::function<void(SlabBox, int)> grow = [&](SlabBox box, int depth) {
    if (depth == 0 || to_unit_float(u()) < 0.2f) {
      p.axis.push_back(leaf);
      return;
    }
    const std::uint8_t axis = u() % 2;
    const float at = box.lo[axis] + (0.2f + 0.6f * to_unit_float(u())) * (box.hi[axis] - box.lo[axis]);
    p.axis.push_back(axis);
    p.split.push_back(at);
    SlabBox lower = box, upper = box;
    lower.hi[axis] = upper.lo[axis] = at;
    grow(lower, depth - 1);
    grow(upper, depth - 1);
  };
  grow({{0, -2}, {1.5f, 3}}, 7);
  return p;
}

TEST(Partition, FindsTheSlabWhoseBoxHoldsThePoint) {
  Pcg32 u(3);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Partition p = random_partition(seed);
    ASSERT_NO_THROW(validate(p));
    const auto boxes = slab_boxes(p);
    ASSERT_EQ(boxes.size(), slab_count(p));
    double area = 0;
    for (const SlabBox& b : boxes) area += double(b.hi[0] - b.lo[0]) * double(b.hi[1] - b.lo[1]);
    EXPECT_NEAR(area, 7.5, 1e-4);
    const auto check = [&](std::array<float, 2> at) {
      const SlabBox& b = boxes[find_slab(p, at)];
      for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_GE(at[c], b.lo[c]);
        // Upper borders belong to the next slab, except those of the whole.
        if (b.hi[c] != p.coordinates[c].hi) {
          EXPECT_LT(at[c], b.hi[c]);
        }
      }
    };
    for (int i = 0; i < 500; ++i) check({1.5f * to_unit_float(u()), 5 * to_unit_float(u()) - 2});
    for (const SlabBox& b : boxes) check({b.lo[0], b.lo[1]});
  }
}

TEST(Partition, RefusesDamage) {
  const Partition good{{{"theta_o", 0, 1}}, {0, leaf, 0, leaf, leaf}, {0.3f, 0.7f}};
  ASSERT_NO_THROW(validate(good));
  const auto refused = [&](const std::function<void(Partition&)>& damage) {
    Partition p = good;
    damage(p);
    EXPECT_THROW(validate(p), Error);
  };
  refused([](Partition& p) { p.axis.pop_back(); });
  refused([](Partition& p) { p.axis.push_back(leaf); });
  refused([](Partition& p) { p.axis.clear(); });
  refused([](Partition& p) { p.axis[0] = 1; });
  refused([](Partition& p) { p.split.pop_back(); });
  refused([](Partition& p) { p.split.push_back(0.5f); });
  refused([](Partition& p) { p.split[1] = 0.3f; });
  refused([](Partition& p) { p.split[1] = 0.1f; });
  refused([](Partition& p) { p.split[0] = std::nanf(""); });
  refused([](Partition& p) { p.coordinates[0].hi = std::nanf(""); });
  refused([](Partition& p) { p.coordinates[0].hi = INFINITY; });
  refused([](Partition& p) { p.coordinates[0].hi = -1; });
  refused([](Partition& p) { p.coordinates.clear(); });
}

}  // namespace
}  // namespace reflectree
