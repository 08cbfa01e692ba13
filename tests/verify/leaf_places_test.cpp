// SPDX-License-Identifier: Apache-2.0
// Bends inside a leaf, too small for any bin.
#include "reflectree/verify/leaf_places.hpp"

#include "suspects.hpp"

namespace reflectree {
namespace {

constexpr std::uint64_t draws = 2'000'000;

std::vector<CheckResult> judge(const Suspect& s) {
  ChiSquareOptions options;
  options.tests = 100;
  return check_leaf_places(s, draws, 1, options);
}

// One-shot mode once more, with places across the leaf that `across` decides: (leaf, random bits) -> (tx,
// ty).
template <class Across>
Suspect drawn_by(const Across& across) {
  Suspect s = built().suspect();
  const PackedSampler& packed = *s.packed;
  s.propose = [&packed, across](Direction wo, Pcg32& u) -> std::optional<Direction> {
    Incidence in;
    if (!find_incidence(packed.viewer, wo, in)) return std::nullopt;
    const PackedSlab& slab = packed.one_shot.slab_at(in);
    const auto chosen =
        detail::choose_leaf(slab, packed.one_shot.leaves.data() + slab.first, detail::bits64(u));
    const Vec2<float> t = across(chosen.leaf, u);
    const auto at = detail::point_at(chosen.leaf, packed.domain.half(), t.x, t.y);
    const bool coin = u() & 1U;
    return from_incidence(in, lift(packed.domain, in.wo, at.p, packed.domain.half() && coin).geometry.wi);
  };
  return s;
}
Vec2<float> across_shape(float slope_x, float slope_y, Pcg32& u) {
  const float a = to_unit_float(u()), b = to_unit_float(u());
  return {detail::sample_linear(slope_x, a), detail::sample_linear(slope_y, b)};
}

TEST(LeafPlaces, AreProductLinear) {
  expect_all_pass(judge(built().suspect()));
  const auto right = judge(drawn_by([](const PackedLeaf& l, Pcg32& u) {
    return across_shape(float(l.slope_x) / 128, float(l.slope_y) / 128, u);
  }));
  expect_all_pass(right);
  for (const CheckResult& r : right) EXPECT_TRUE(r.decided) << to_line(r);
}

TEST(LeafPlacesTwin, ASlopeOffByOneOf128) {
  const auto steeper = [](std::int8_t slope) { return float(slope < 0 ? slope - 1 : slope + 1) / 128; };
  EXPECT_TRUE(fails(judge(drawn_by([=](const PackedLeaf& l, Pcg32& u) {
                      return across_shape(steeper(l.slope_x), float(l.slope_y) / 128, u);
                    })),
                    "leaf_slope_x"));
  EXPECT_TRUE(fails(judge(drawn_by([=](const PackedLeaf& l, Pcg32& u) {
                      return across_shape(float(l.slope_x) / 128, steeper(l.slope_y), u);
                    })),
                    "leaf_slope_y"));
}

TEST(LeafPlacesTwin, SixteenBits) {
  const auto coarse = [](float t) { return std::floor(t * 65536) / 65536; };
  for (const bool along_x : {true, false}) {
    EXPECT_TRUE(fails(judge(drawn_by([=](const PackedLeaf& l, Pcg32& u) {
                        const float a = to_unit_float(u()), b = to_unit_float(u());
                        return Vec2<float>{
                            detail::sample_linear(float(l.slope_x) / 128, along_x ? coarse(a) : a),
                            detail::sample_linear(float(l.slope_y) / 128, along_x ? b : coarse(b))};
                      })),
                      "leaf_distinct"))
        << along_x;
  }
}

TEST(LeafPlacesTwin, AStepInsideTheLeaf) {
  EXPECT_TRUE(fails(judge(drawn_by([](const PackedLeaf& l, Pcg32& u) {
                      Vec2<float> t = across_shape(float(l.slope_x) / 128, float(l.slope_y) / 128, u);
                      if (u() % 16 == 0) t.x = 0.5f + 0.02f * (t.x - 0.5f);  // a knot in the middle
                      return t;
                    })),
                    "leaf_shape"));
}

}  // namespace
}  // namespace reflectree
