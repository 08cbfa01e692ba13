// SPDX-License-Identifier: Apache-2.0
// The grid that begins a search for a slab, beside the partition itself.
#include "reflectree/sampler/known/slab_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "reflectree/math/random.hpp"
#include "reflectree/sampler/known/cosine_lookup.hpp"

namespace reflectree {
namespace {

// A random tree over two to four coordinates. Halved: every split in the middle, as a builder does it.
Partition random_partition(std::uint64_t seed, std::size_t others, bool halved, int depth) {
  Partition p;
  p.coordinates = {{"theta_o", 0, 1.5707887f}};
  for (std::size_t i = 0; i < others; ++i) p.coordinates.push_back({"p", -3.912023f, 0.7f * float(i)});
  Pcg32 u(seed);
  const std::function<void(SlabBox, int)> grow = [&](SlabBox box, int levels) {
    if (levels == 0 || to_unit_float(u()) < 0.1f) return p.axis.push_back(Partition::leaf);
    const std::size_t axis = u() % (1 + others);
    const float share = halved ? 0.5f : 0.1f + 0.8f * to_unit_float(u());
    const float at = linear_mix(share, box.lo[axis], box.hi[axis]);
    p.axis.push_back(std::uint8_t(axis)), p.split.push_back(at);
    SlabBox lower = box, upper = box;
    lower.hi[axis] = upper.lo[axis] = at;
    grow(lower, levels - 1), grow(upper, levels - 1);
  };
  SlabBox whole;
  for (const KnownCoordinate& c : p.coordinates) whole.lo.push_back(c.lo), whole.hi.push_back(c.hi);
  grow(whole, depth);
  return p;
}

// The same over the cosine, which the tree compares: what ascends with theta_o is its negative.
Partition by_cosine(Partition p) {
  std::size_t inner = 0;
  for (const std::uint8_t axis : p.axis) {
    if (axis == Partition::leaf) continue;
    if (axis == 0) p.split[inner] = -std::cos(p.split[inner]);
    ++inner;
  }
  return p;
}

TEST(SlabTree, FindsTheSlabOfThePartition) {
  Pcg32 u(7);
  std::size_t asked = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const std::size_t others = 1 + seed % 3;
    const Partition p = random_partition(seed, others, seed % 2 == 0, 4 + int(seed % 7));
    ASSERT_NO_THROW(validate(p));
    const Partition expected = by_cosine(p);
    const SlabTree tree(p);
    const auto check = [&](const std::array<float, 4>& at) {
      const std::array<float, 4> known{-at[0], at[1], at[2], at[3]};
      ++asked;
      return tree(at[0], at.data() + 1) == find_slab(expected, {known.data(), 1 + others});
    };
    const auto anywhere = [&](std::size_t axis) {
      const KnownCoordinate& c = p.coordinates[axis];
      return linear_mix(to_unit_float(u()), c.lo, c.hi);
    };
    const auto place = [&] {
      std::array<float, 4> at{std::max(std::cos(anywhere(0)), min_cos_theta_o)};
      for (std::size_t a = 1; a <= others; ++a) at[a] = anywhere(a);
      return at;
    };
    for (int i = 0; i < 1000; ++i) EXPECT_TRUE(check(place())) << seed;
    // On borders and beside them, at the ends, and a rounding outside.
    std::size_t inner = 0;
    for (const std::uint8_t axis : p.axis) {
      if (axis == Partition::leaf) continue;
      const float split = axis == 0 ? std::cos(p.split[inner]) : p.split[inner];
      ++inner;
      for (const float beside : {split, std::nextafter(split, -9.f), std::nextafter(split, 9.f)}) {
        std::array<float, 4> at = place();
        at[axis] = beside;
        EXPECT_TRUE(check(at)) << seed << ", border " << split;
      }
    }
    for (const float c : {min_cos_theta_o, 0x1p-6f, std::nextafter(1.f, 0.f), 1.f}) {
      std::array<float, 4> at = place();
      at[0] = c;
      EXPECT_TRUE(check(at)) << seed << ", cosine " << c;
    }
    for (std::size_t a = 1; a <= others; ++a) {
      for (const float end : {p.coordinates[a].lo, p.coordinates[a].hi}) {
        for (const float x : {end, std::nextafter(end, -9.f), std::nextafter(end, 9.f)}) {
          std::array<float, 4> at = place();
          at[a] = x;
          EXPECT_TRUE(check(at)) << seed << ", end " << x;
        }
      }
    }
  }
  EXPECT_GT(asked, 60'000U);
}

// Parameters known by their logarithm are looked up as they are given.
TEST(SlabTree, FindsParametersWithoutALogarithm) {
  const std::vector<KnownParameter> parameters{{{"p", 0.02f, 1}, true}, {{"p", -3.912023f, 0.7f}, false}};
  Pcg32 u(11);
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Partition p = random_partition(seed, 2, seed % 2 == 0, 4 + int(seed % 6));
    const SlabTree tree(p, parameters);
    Partition expected = by_cosine(p);
    std::size_t inner = 0;
    std::vector<float> places{0.02f, 1};
    for (const std::uint8_t axis : p.axis) {
      if (axis == Partition::leaf) continue;
      float& split = expected.split[inner++];
      if (axis != 1) continue;
      split = value_of(parameters[0], split);
      for (const float x : {split, std::nextafter(split, 0.f), std::nextafter(split, 2.f)})
        places.push_back(x);
    }
    for (int i = 0; i < 500; ++i) places.push_back(0.02f + 0.98f * to_unit_float(u()));
    for (const float alpha : places) {
      const float c = std::max(to_unit_float(u()), min_cos_theta_o),
                  other = 4.6f * to_unit_float(u()) - 3.912023f;
      const float at[2] = {alpha, other}, known[3] = {-c, alpha, other};
      EXPECT_EQ(tree(c, at), find_slab(expected, known)) << seed << ' ' << alpha;
    }
  }
}

// phi_o is looked up by its key, for viewers all around the circle. The twin: the azimuth itself for its key.
TEST(SlabTree, FindsTheAzimuthByItsKey) {
  Pcg32 u(13);
  std::size_t asked = 0, seen = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Partition p = random_partition(seed, 1, seed % 2 == 0, 4 + int(seed % 6));
    for (std::size_t i = 0, inner = 0; i < p.axis.size(); ++i) {
      if (p.axis[i] == Partition::leaf) continue;
      float& split = p.split[inner++];
      const KnownCoordinate& c = p.coordinates[1];
      if (p.axis[i] == 1) split = 2 * pi * (split - c.lo) / (c.hi - c.lo);
    }
    p.coordinates[1] = {"phi_o", 0, 2 * pi};
    const SlabTree tree(p);
    const Partition expected = by_cosine(p);
    for (int i = 0; i < 1000; ++i) {
      const float phi = 2 * pi * to_unit_float(u()), c = std::max(to_unit_float(u()), min_cos_theta_o);
      const float key = azimuth_key(ViewerSymmetry::none, std::cos(phi), std::sin(phi));
      EXPECT_NEAR(key, azimuth_key(phi), 1e-6f);
      const bool beside_a_border = std::any_of(p.split.begin(), p.split.end(),
                                               [&](float split) { return std::abs(split - phi) < 1e-5f; });
      if (beside_a_border) continue;
      const float known[2] = {-c, phi};
      ++asked;
      EXPECT_EQ(tree(c, &key), find_slab(expected, known)) << seed << ' ' << phi;
      seen += tree(c, &phi) != find_slab(expected, known);
    }
  }
  EXPECT_GT(asked, 29'000U);
  EXPECT_GT(seen, 1000U);
}

// A search begins next to its end, and what that takes is small beside the leaves.
TEST(SlabTree, OfOneSlab) {
  Partition p = random_partition(1, 1, true, 0);
  const SlabTree tree(p);
  const float other = -1;
  EXPECT_FALSE(tree.empty());
  EXPECT_EQ(tree(1, &other), 0U);
  EXPECT_EQ(tree(min_cos_theta_o, &other), 0U);
  EXPECT_LT(tree.bytes(), 2000U);
}

}  // namespace
}  // namespace reflectree
