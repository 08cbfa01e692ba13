// SPDX-License-Identifier: Apache-2.0
// Borders of the patches of a matrix, to the last bit: on which side a viewer stands is decided by f, by the slabs
// and by the albedo alike; and bounds hold where places of a leaf round into the patch beside it.
#include <gtest/gtest.h>

#include <cmath>

#include "functions.hpp"
#include "majorant_field.hpp"
#include "reflectree/brdf/tables/klems_table.hpp"

namespace reflectree {
namespace {

constexpr double degree = pi_v<double> / 180;

// Many of its borders are halves of halves of the square: azimuths of 11.25 and 22.5 degrees and more of them,
// elevations of 30 and 45. Odd rings have borders where azimuths go round.
KlemsTable matrix(bool seen_through) {
  KlemsTable table;
  table.seen_through = seen_through;
  table.incident = KlemsBasis({0, 5 * degree, 25 * degree, 45 * degree, 90 * degree}, {1, 3, 4, 8});
  table.exiting = KlemsBasis({0, 10 * degree, 30 * degree, 45 * degree, 90 * degree}, {3, 8, 5, 16});
  Pcg32 u(12);
  for (int i = 0; i < table.incident.size() * table.exiting.size(); ++i)
    table.values.push_back(u() % 4 ? 0.01f : 0.5f + to_unit_float(u()));
  return table;
}

BuildOptions quick() {
  BuildOptions options;
  options.one_shot_variance = 0.2f;
  return options;
}

// Viewers within some roundings of every border.
template <class Visit>
void for_each_viewer_at_a_border(const BrdfTraits& traits, const Visit& visit) {
  Pcg32 u(5);
  const auto near = [&] { return 4e-7 * (2 * to_unit_double(u()) - 1); };
  const auto at = [](double theta, double phi) {
    return Direction{float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
                     float(std::cos(theta))};
  };
  double begin = 0;
  for (const AzimuthKnots& band : traits.phi_o_knots) {
    const auto end = double(band.theta_o_end);
    for (int i = 0; i < 300; ++i) {
      for (const float phi : band.phi_o)
        visit(at(linear_mix(to_unit_double(u()), begin, min(end, 1.57)), double(phi) + near()));
      if (end < 1.57) visit(at(end + near(), 2 * pi_v<double> * to_unit_double(u())));
    }
    begin = end;
  }
}

struct Seen {
  int viewers = 0, other_albedos = 0, overshoots = 0;
};
template <class F>
Seen seen_at_borders(const F& f, const SamplerData& data) {
  const auto s = make_sampler(AnyBrdf(f), data);
  const BrdfTraits traits = matrix(f.seen_through).traits();
  Seen seen;
  Pcg32 u(6);
  for_each_viewer_at_a_border(traits, [&](Direction wo) {
    ++seen.viewers;
    const double told = traits.albedo(wo);
    seen.other_albedos += std::abs(double(s.exact.albedo(wo)) - told) > 1e-5 * told;
    for (int i = 0; i < 4; ++i) {
      FirstTrial first;
      s.exact.sample(wo, u, first);
      seen.overshoots += first.ratio > 1;
    }
  });
  return seen;
}

// Places at the ends of every leaf, and one step inside, for a viewer in the middle of its slab.
int overshoots_at_leaf_ends(const AnyBrdf& f, const SamplerData& data) {
  const auto s = make_sampler(f, data);
  const PackedForest& forest = s.exact.packed().exact;
  const std::vector<SlabBox> boxes = slab_boxes(data.exact_partition);
  constexpr float step = 0x1p-24f, shares[] = {0, step, 0.37f, 1 - step, 1};
  int overshoots = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Direction wo = direction_from_angles(0.5f * (boxes[i].lo[0] + boxes[i].hi[0]),
                                               0.5f * (boxes[i].lo[1] + boxes[i].hi[1]));
    const float albedo = s.exact.albedo(wo);
    for (std::uint32_t k = 0; k < forest.slabs[i].count; ++k) {
      const PackedLeaf& leaf = forest.leaves[forest.slabs[i].first + k];
      for (const float tx : shares) {
        for (const float ty : shares) {
          const detail::PointInLeaf at = detail::point_at(leaf, false, tx, ty);
          const DomainPoint point = lift(data.domain, wo, at.p);
          const float t = data.target(f(shading_geometry(wo, point.geometry.wi))) * point.projected_area;
          overshoots += t > albedo * at.height;
        }
      }
    }
  }
  return overshoots;
}

TEST(PatchBorders, ViewersStandOnOneSide) {
  for (const bool seen_through : {false, true}) {
    const KlemsTable f = matrix(seen_through);
    const SamplerData data = build(AnyBrdf(f), quick());
    EXPECT_LE(data.report.expected_trials, 1.25f);
    const Seen seen = seen_at_borders(f, data);
    EXPECT_GT(seen.viewers, 5000);
    EXPECT_EQ(seen.other_albedos, 0) << seen_through;
    EXPECT_EQ(seen.overshoots, 0) << seen_through;
    EXPECT_EQ(overshoots_at_leaf_ends(f, data), 0) << seen_through;
  }
}

// The judges can fail. By the arctangent f is on another side than the slabs for some viewers.
struct ByArctangent : KlemsTable {
  float operator()(const ShadingGeometry<float>& g) const {
    const float phi = angle_of(g.wo.y, g.wo.x), theta = g.cos_theta_o;
    const float away = std::sqrt(max(1 - theta * theta, 0.f));
    ShadingGeometry<float> moved = g;
    moved.wo = {away * std::cos(phi), away * std::sin(phi), g.wo.z};
    return KlemsTable::operator()(moved);
  }
};
TEST(PatchBordersTwin, AnotherRounding) {
  const ByArctangent f{matrix(false)};
  const Seen seen = seen_at_borders(f, build(AnyBrdf(f), quick()));
  EXPECT_GT(seen.overshoots, 20);
}
// Patches told with borders that are off by more than rounding.
struct BordersMoved : KlemsTable {
  BrdfTraits traits() const {
    BrdfTraits t = KlemsTable::traits();
    for (PatchBand& band : t.patches) {
      for (float& phi : band.phi_i) phi += 1e-5f;
    }
    return t;
  }
};
TEST(PatchBordersTwin, BordersOfPatchesThatAreOff) {
  const BordersMoved f{matrix(false)};
  EXPECT_GT(overshoots_at_leaf_ends(AnyBrdf(f), build(AnyBrdf(f), quick())), 20);
}

}  // namespace
}  // namespace reflectree
