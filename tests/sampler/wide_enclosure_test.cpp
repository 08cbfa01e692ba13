// SPDX-License-Identifier: Apache-2.0
// The contract of enclosures of anisotropic measured tables: over random boxes of viewers of any azimuth they hold what
// the table returns, whether the proof tells azimuths or not. All data is random.
#include <gtest/gtest.h>

#include "azimuth_boxes.hpp"
#include "reflectree/brdf/tables/rgl_wide_table.hpp"

namespace reflectree {
namespace {

using namespace azimuth_boxes;

std::vector<float> nodes(float first, float last, int count) {
  std::vector<float> out;
  for (int i = 0; i < count; ++i) out.push_back(first + (last - first) * float(i) / float(count - 1));
  return out;
}

// Noise, some of it negative; `bright`: of some nodes of the colours.
AnyBrdf random_rgl(Pcg32& bits, int reduction, float bright = 0) {
  RglWideFields f;
  f.reduction = reduction;
  f.phi_o = nodes(-pi, -pi + 2 * pi / float(reduction), 4), f.theta_o = {0.f, 0.5f, 1.1f, 1.5707964f};
  f.warp_width = 9, f.warp_height = 13, f.colour_width = 6, f.colour_height = 7;
  const auto fill = [&](std::vector<float>& v, std::size_t n, double lo) {
    for (std::size_t i = 0; i < n; ++i) v.push_back(float(lo + (1 - lo) * uniform(bits)));
  };
  f.sigma = {6, 5, {}}, f.ndf = {8, 7, {}};
  fill(f.sigma.values, 30, 0.3), fill(f.ndf.values, 56, 0.1);
  fill(f.vndf, 16 * 9 * 13, 0.05), fill(f.colours, 16 * 3 * 6 * 7, -0.1);
  for (std::size_t i = 0; i < f.colours.size(); i += 5) f.colours[i] += bright;
  return RglWideTable(f);
}

// What f returns, held against what the enclosure of `told` says; where `tells`, of azimuths that are turned by `off`.
Seen compare_tables(const AnyBrdf& told, const AnyBrdf& f, bool tells, int boxes, double off = 0) {
  const BrdfEnclosure& enclosure = *told.traits().enclosure;
  return compare(
      [&](const Box& box, ShadingGeometry<AffineForm> g) {
        const AffineForm rounded = AffineForm::anything_in({off - 3e-7, off + 3e-7});
        if (tells) g.viewer = KnownViewer{widened(sin(box.variable(0)), 1e-6), box.variable(3) + rounded};
        if (tells && g.azimuth_h) g.viewer->azimuth_h = g.azimuth_h->angle;
        return enclosure(g).g;
      },
      [&](const Point& at, const ShadingGeometry<float>& g) {
        // The normal has no azimuth but 0.
        const bool none = tells && g.wo.x == 0 && g.wo.y == 0 && at[3] > 0;
        return none ? std::optional<float>() : f(g).data()[f.channels() > 1 ? 1 : 0];
      },
      boxes);
}

TEST(WideEnclosure, HoldsRglTables) {
  for (const int reduction : {1, 2, 4}) {
    for (const bool tells : {false, true}) {
      Pcg32 bits(5);
      Seen all;
      for (int i = 0; i < 6; ++i) {
        const AnyBrdf f = random_rgl(bits, reduction);
        const Seen seen = compare_tables(f, f, tells, 60);
        all.missed += seen.missed, all.finite += seen.finite, all.boxes += seen.boxes;
      }
      EXPECT_EQ(all.missed, 0) << reduction << tells;
      EXPECT_GT(all.finite, all.boxes / 2) << "an enclosure of everything would prove nothing";
    }
  }
}
TEST(WideEnclosureTwin, AnotherRglTableIsFound) {
  for (const float bright : {-0.02f, 0.02f}) {
    Pcg32 bits(5), same(5);
    const AnyBrdf f = random_rgl(bits, 4), other = random_rgl(same, 4, bright);
    EXPECT_GT(compare_tables(f, other, true, 300).missed, 0) << bright;
  }
}
TEST(WideEnclosureTwin, AWrongAzimuthIsFound) {
  for (const int reduction : {1, 2, 4}) {
    Pcg32 bits(5);
    const AnyBrdf f = random_rgl(bits, reduction);
    EXPECT_GT(compare_tables(f, f, true, 300, 0.01).missed, 0) << reduction;
  }
}

}  // namespace
}  // namespace reflectree
