// SPDX-License-Identifier: Apache-2.0
// Parameters and widths as a sample reads them, beside the library's logarithms and exponentials.
#include "reflectree/sampler/known/packed_family.hpp"

#include <gtest/gtest.h>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

TEST(PackedFamily, CoordinatesAndWidths) {
  const std::vector<KnownParameter> parameters{{{"alpha", 0.02f, 1}, true}, {{"weight", -2, 0.5f}, false}};
  const std::array<float, 3> laws[] = {{0.3f, 0.9f, -1.2f}, {-0.5f, -0.7f, 0}, {0, 0, 2}, {}};
  Pcg32 u(5);
  for (const auto& x : laws) {
    for (const auto& y : laws) {
      const ScaleLaw law{x, y};
      const PackedFamily packed = pack(parameters, law);
      for (int i = 0; i < 2000; ++i) {
        // Both ends of both, then anywhere.
        const float a = i < 4 ? float(i % 2) : to_unit_float(u()),
                    b = i < 4 ? float(i / 2) : to_unit_float(u());
        const Parameters values{clamp(0.02f * std::pow(50.f, a), 0.02f, 1.f), linear_mix(b, -2.f, 0.5f)};
        Coordinates at;
        ASSERT_TRUE(find_coordinates(packed, values, at));
        EXPECT_NEAR(double(at[0]), std::log(double(values[0])), 1e-6);
        EXPECT_EQ(at[1], values[1]);
        EXPECT_GE(at[0], lowest(parameters[0]));
        EXPECT_LE(at[0], highest(parameters[0]));
        for (const auto& [found, right] :
             {std::pair(packed.x.at(at), scale_by(x, at)), std::pair(packed.y.at(at), scale_by(y, at))}) {
          EXPECT_NEAR(double(found), double(right), 2e-6 * double(right));
        }
      }
    }
  }
}

TEST(PackedFamily, OutsideOfARange) {
  const std::vector<KnownParameter> parameters{{{"alpha", 0.02f, 1}, true}, {{"weight", -2, 0.5f}, false}};
  const PackedFamily packed = pack(parameters, {});
  Coordinates at;
  for (const float alpha : {0.0199f, 1.001f, 0.f, -1.f, NAN, INFINITY, -INFINITY})
    EXPECT_FALSE(find_coordinates(packed, {alpha, 0}, at)) << alpha;
  for (const float weight : {-2.001f, 0.501f, NAN, INFINITY, -INFINITY})
    EXPECT_FALSE(find_coordinates(packed, {0.1f, weight}, at)) << weight;
  EXPECT_TRUE(find_coordinates(packed, {0.02f, -2}, at));
  EXPECT_TRUE(find_coordinates(packed, {1, 0.5f}, at));
}

}  // namespace
}  // namespace reflectree
