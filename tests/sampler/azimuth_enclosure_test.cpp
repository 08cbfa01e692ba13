// SPDX-License-Identifier: Apache-2.0
// Enclosures where the azimuth of the viewer matters, and where a parameter varies: over random boxes of viewers and
// places they hold what models return, in the domains that live in the frame of the surface.
#include <gtest/gtest.h>

#include "azimuth_boxes.hpp"
#include "functions.hpp"
#include "reflectree/brdf/material/model_family.hpp"
#include "reflectree/brdf/models/all.hpp"

namespace reflectree {
namespace {

using namespace azimuth_boxes;

template <class M>
Seen compare_model(const M& model, float scale = 1) {
  return compare([&](const Box&, const auto& g) { return model(g).g; },
                 [&](const Point&, const auto& g) { return scale * model(g).g; }, 400);
}

TEST(AzimuthEnclosure, HoldsAnisotropicModels) {
  for (const float degrees : {0.f, 30.f}) {
    const Seen seen[] = {
        compare_model(Ggx{Widths(0.05f, 0.3f), {1, 0.8f, 0.3f}, degrees}),
        compare_model(Ward{{}, {0.6f, 0.6f, 0.6f}, 0.1f, 0.4f, degrees}),
        compare_model(AshikhminShirley{{}, {0.05f, 0.05f, 0.05f}, 10, 100, degrees}),
        compare_model(CookTorrance{{}, {0.8f, 0.8f, 0.8f}, {1, 1, 1}, Widths(0.1f, 0.4f), degrees}),
        compare_model(Plastic{{}, 0.04f, Widths(0.1f, 0.4f), degrees})};
    for (const Seen& s : seen) {
      EXPECT_EQ(s.missed, 0);
      EXPECT_GT(s.finite, s.boxes / 3) << "an enclosure of everything would prove nothing";
    }
  }
}
TEST(AzimuthEnclosureTwin, AnotherFunctionIsFound) {
  EXPECT_GT(compare_model(Ggx{Widths(0.05f, 0.3f)}, 1.002f).missed, 0);
  EXPECT_GT(compare_model(Ward{{}, {0.6f, 0.6f, 0.6f}, 0.1f, 0.4f}, 1.002f).missed, 0);
}

// A width that varies with the box.
Seen compare_family(double off) {
  const AnyFamily family = model_family(Ggx{}, {{"alpha", 0.01f, 1}});
  return compare([&](const Box& box, const auto& g) { return (*family.enclosure())(g, {box.variable(4)}).g; },
                 [&](const Point& at, const auto& g) { return family(g, {float(off * at[4])}).data()[1]; },
                 400);
}
TEST(FamilyEnclosure, HoldsItsMembers) {
  const Seen seen = compare_family(1);
  EXPECT_EQ(seen.missed, 0);
  EXPECT_GT(seen.finite, seen.boxes / 3);
}
TEST(FamilyEnclosureTwin, AnotherMemberIsFound) { EXPECT_GT(compare_family(1.01).missed, 0); }

TEST(FamilyEnclosure, IsMissingWhereFormulasChange) {
  EXPECT_TRUE(model_family(Ggx{Widths(0.3f, 0.1f)}, {{"alpha_y", 0.02f, 0.2f}})
                  .f.enclosure({{"alpha_y", 0.02f, 0.2f}}));
  EXPECT_FALSE(model_family(Ggx{Widths(0.3f, 0.1f)}, {{"alpha_y", 0.02f, 0.5f}})
                   .f.enclosure({{"alpha_y", 0.02f, 0.5f}}));
}

TEST(AzimuthEnclosure, SmallerBoxesGiveNarrowerForms) {
  const Ggx model{Widths(0.2f, 0.3f)};
  for (int i = 0; i < 5; ++i) {
    const auto radius_of = [&](double share) {
      Box box;
      const Point centre{0.7, 0.3, 0.4, 2, 0.3};
      for (std::size_t k = 0; k < 5; ++k) box.lo[k] = centre[k] - share, box.hi[k] = centre[k] + share;
      const DomainPointT<AffineForm> lift = lifted_box(domain_at(i), box);
      return (model(lift.geometry).g * lift.projected_area).error;
    };
    EXPECT_LT(radius_of(0.002), 0.6 * radius_of(0.004)) << i;
  }
}

}  // namespace
}  // namespace reflectree
