// SPDX-License-Identifier: Apache-2.0
// The contract of enclosures of anisotropic measured tables: over random boxes of viewers of any azimuth they hold what
// the table returns, whether the proof tells azimuths or not. All data is random.
#include <gtest/gtest.h>

#include "azimuth_boxes.hpp"
#include "reflectree/brdf/material/mixture.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/brdf/tables/rgl_wide_table.hpp"
#include "reflectree/brdf/tables/specular_table.hpp"
#include "reflectree/brdf/target.hpp"

namespace reflectree {
namespace {

using namespace azimuth_boxes;

std::vector<float> nodes(float first, float last, int count) {
  std::vector<float> out;
  for (int i = 0; i < count; ++i) out.push_back(first + (last - first) * float(i) / float(count - 1));
  return out;
}

// Noise, some of it negative; `bright`: of some nodes of the colours.
AnyBrdf random_rgl(Pcg32& bits, int reduction, float bright = 0, int channels = 3) {
  RglWideFields f;
  f.reduction = reduction, f.channels = channels;
  f.phi_o = nodes(-pi, -pi + 2 * pi / float(reduction), 4), f.theta_o = {0.f, 0.5f, 1.1f, 1.5707964f};
  f.warp_width = 9, f.warp_height = 13, f.colour_width = 6, f.colour_height = 7;
  const auto fill = [&](std::vector<float>& v, std::size_t n, double lo) {
    for (std::size_t i = 0; i < n; ++i) v.push_back(float(lo + (1 - lo) * uniform(bits)));
  };
  f.sigma = {6, 5, {}}, f.ndf = {8, 7, {}};
  fill(f.sigma.values, 30, 0.3), fill(f.ndf.values, 56, 0.1);
  fill(f.vndf, 16 * 9 * 13, 0.05), fill(f.colours, std::size_t(16 * channels * 6 * 7), -0.1);
  for (std::size_t i = 0; i < f.colours.size(); i += 5) f.colours[i] += bright;
  return RglWideTable(f);
}

// Turns go round: the last rotation and azimuth are the first.
AnyBrdf random_specular(Pcg32& bits, float bright = 0) {
  SpecularTable<float> t;
  t.axes.rotation = {0.f, 1.f, 2.5f, 4.f, 2 * pi}, t.axes.theta_o = {0.f, 0.6f, 1.3f};
  t.axes.azimuth = {0.f, 1.f, 2.f, pi, 5.f, 2 * pi}, t.axes.radial = {0.f, 0.1f, 0.4f, 1.f, 2.2f};
  for (std::size_t i = 0; i < t.axes.size(); ++i)
    t.values.push_back(float(1.1 * uniform(bits) - 0.1) + (i % 5 == 0 ? bright : 0));
  const std::size_t row = 5, slice = 6 * row, turn = 4 * 3 * slice;
  for (std::size_t i = 0; i < 3 * slice; ++i) t.values[turn + i] = t.values[i];
  for (std::size_t first = 0; first < t.values.size(); first += slice)
    for (std::size_t i = 0; i < row; ++i) t.values[first + 5 * row + i] = t.values[first + i];
  return t;
}

// What f returns, held against what the enclosure of `told` says; where `tells`, of azimuths that are turned by `off`.
Seen compare_tables(const AnyBrdf& told, const AnyBrdf& f, bool tells, int boxes, double off = 0,
                    const Target& target = {}) {
  const BrdfEnclosure& enclosure = *told.traits().enclosure;
  return compare(
      [&](const Box& box, ShadingGeometry<AffineForm> g) {
        const AffineForm rounded = AffineForm::anything_in({off - 3e-7, off + 3e-7});
        if (tells) g.viewer = KnownViewer{widened(sin(box.variable(0)), 1e-6), box.variable(3) + rounded};
        if (tells && g.azimuth_h) g.viewer->azimuth_h = g.azimuth_h->angle;
        return enclosure.reduces_channels() ? enclosure.reduced(target, g, false) : enclosure(g).g;
      },
      [&](const Point& at, const ShadingGeometry<float>& g) {
        // The normal has no azimuth but 0.
        const bool none = tells && g.wo.x == 0 && g.wo.y == 0 && at[3] > 0;
        if (none) return std::optional<float>();
        const Spectrum value = f(g);
        return std::optional(f.channels() > 3 ? target(value) : value.data()[f.channels() > 1 ? 1 : 0]);
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
TEST(WideEnclosure, HoldsTargetsOfManyChannels) {
  const Target targets[] = {{TargetKind::norm, 0, 1},
                            {TargetKind::luminance, 0, 0.5f},
                            {TargetKind::maximum, 0, 2},
                            {TargetKind::channel, 4, 1},
                            {TargetKind::channel, 99, 1}};
  for (const Target& target : targets) {
    Pcg32 bits(6);
    const AnyBrdf f = random_rgl(bits, 4, 0, 7);
    const Seen seen = compare_tables(f, f, true, 150, 0, target);
    EXPECT_EQ(seen.missed, 0) << int(target.kind);
    EXPECT_GT(seen.finite, seen.boxes / 2);
    Pcg32 same(6);
    EXPECT_GT(compare_tables(f, random_rgl(same, 4, 0.02f, 7), true, 300, 0, target).missed, 0)
        << int(target.kind);
  }
}
TEST(WideEnclosure, HoldsSpecularTables) {
  for (const bool tells : {false, true}) {
    Pcg32 bits(5);
    Seen all;
    for (int i = 0; i < 6; ++i) {
      const AnyBrdf f = random_specular(bits);
      const Seen seen = compare_tables(f, f, tells, 60);
      all.missed += seen.missed, all.finite += seen.finite, all.boxes += seen.boxes;
    }
    EXPECT_EQ(all.missed, 0) << tells;
    EXPECT_GT(all.finite, all.boxes / 2);
  }
}
TEST(WideEnclosureTwin, AnotherSpecularTableIsFound) {
  for (const float bright : {-0.02f, 0.02f}) {
    Pcg32 bits(5), same(5);
    const AnyBrdf f = random_specular(bits), other = random_specular(same, bright);
    EXPECT_GT(compare_tables(f, other, true, 300).missed, 0) << bright;
  }
  Pcg32 bits(5);
  const AnyBrdf f = random_specular(bits);
  EXPECT_GT(compare_tables(f, f, true, 300, 0.01).missed, 0);
}

// Towards the rim a sum with such a table tells f cos theta_i, which stays bounded where 1 / cos theta_i does not.
TEST(WideEnclosure, OfASumTellsItTimesTheCosine) {
  Pcg32 bits(5);
  const AnyBrdf table = random_rgl(bits, 4),
                sum = mixture({{0.5f, table}, {2.f, Enclosed<Lambert>(Lambert{})}});
  const BrdfEnclosure& enclosure = *sum.traits().enclosure;
  EXPECT_FALSE(mixture({{0.5f, Enclosed<Lambert>(Lambert{})}, {2.f, Enclosed<Lambert>(Lambert{})}})
                   .traits()
                   .enclosure->times_cosine({}));
  Seen seen;
  for (const float scale : {1.f, 1.01f}) {
    seen = compare(
        [&](const Box&, const ShadingGeometry<AffineForm>& g) { return enclosure.times_cosine(g)->g; },
        [&](const Point&, const ShadingGeometry<float>& g) {
          return std::optional(scale * sum(g).data()[1] * g.cos_theta_i);
        },
        300);
    if (scale == 1) {
      EXPECT_EQ(seen.missed, 0);
    } else {
      EXPECT_GT(seen.missed, 0);
    }
  }
}

TEST(WideEnclosure, SharperBoxesGiveSharperBounds) {
  Pcg32 bits(7);
  for (const AnyBrdf& f : {random_rgl(bits, 1), random_rgl(bits, 4), random_specular(bits)}) {
    int looked = 0, sharper = 0;
    for (int i = 0; i < 100; ++i) {
      const Domain domain = domain_at(i);
      const double share = 0.01 * std::pow(0.5, uniform(bits));
      const auto width_of = [&](double radius) {
        Box box;
        const Point centre{0.7, 0.3, 0.4, 2, 0.3};
        for (std::size_t k = 0; k < 5; ++k) box.lo[k] = centre[k] - radius, box.hi[k] = centre[k] + radius;
        const DomainPointT<AffineForm> at = lifted_box(domain, box);
        const RealInterval range = ((*f.traits().enclosure)(at.geometry).g * at.projected_area).range;
        return range.hi - range.lo;
      };
      const double wide = width_of(share), narrow = width_of(share / 2);
      if (!(wide > 1e-4)) continue;
      ++looked, sharper += narrow < 0.75 * wide;
    }
    EXPECT_GT(looked, 50);
    EXPECT_EQ(sharper, looked);
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
