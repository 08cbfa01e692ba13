// SPDX-License-Identifier: Apache-2.0
// Functions that change by steps, or within few degrees, when the viewer moves: both sides of a step are
// right, and what is too narrow for the table of the albedo is said.
#include <gtest/gtest.h>

#include <cmath>

#include "functions.hpp"
#include "reflectree/brdf/tables/klems_table.hpp"
#include "reflectree/brdf/tables/specular_table.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/sampler_file.hpp"

namespace reflectree {
namespace {

bool in_wedge(Direction wo, float half_width) {
  return std::abs(std::remainder(std::atan2(wo.y, wo.x) - 1.f, 2 * pi)) < half_width;
}

// Brighter for viewers within an azimuth.
struct Wedge {
  float half_width, brighter;
  float operator()(Direction wo, Direction) const { return in_wedge(wo, half_width) ? brighter : 0.2f; }
};

// The wedge's albedo is known: pi f.
double worst_miss(const SamplerData& data, const Wedge& f) {
  const auto s = make_sampler(f, data);
  Pcg32 u(5);
  double worst = 0;
  for (int i = 0; i < 4000; ++i) {
    const float phi =
        i % 2 ? 2 * pi * to_unit_float(u()) : 1 + 1.5f * f.half_width * (2 * to_unit_float(u()) - 1);
    if (std::abs(std::abs(phi - 1) - f.half_width) < 2e-5f) continue;
    const Direction wo = wo_at(88 * to_unit_double(u()), double(phi));
    const double truth = pi_v<double> * double(in_wedge(wo, f.half_width) ? f.brighter : 0.2f);
    worst = std::max(worst, std::abs(double(s.exact.albedo(wo)) / truth - 1));
  }
  return worst;
}

TEST(ViewerSteps, AWedgeOfAzimuthsHasBothItsSides) {
  for (const float width : {0.3f, 0.0524f, 0.0087f}) {
    const Wedge f{width, 0.26f};
    const SamplerData data = build(AnyBrdf(f));
    EXPECT_LE(data.albedo.relative_error, 2e-4f) << width;
    EXPECT_LE(worst_miss(data, f), double(data.albedo.relative_error)) << width;
    EXPECT_LE(data.report.expected_trials, 1.25f) << width;
    EXPECT_EQ(decode_sampler(encode_sampler(data), "memory"), data);
  }
}
// The judge can fail: a table that knows nothing of the wedge.
TEST(ViewerStepsTwin, ATableWithoutTheWedge) {
  const Wedge f{0.3f, 0.26f};
  SamplerData data = build(AnyBrdf(f));
  std::fill(data.albedo.albedo.begin(), data.albedo.albedo.end(), 0.2f * pi);
  EXPECT_GT(worst_miss(data, f), 0.1);
}

// Right, or a sentence: never a table that states less than it misses.
TEST(ViewerSteps, WhatIsTooNarrowIsStatedOrRefused) {
  const auto bump = [](float width) {
    return [width](Direction wo, Direction) {
      const float a = std::remainder(std::atan2(wo.y, wo.x) - 1.f, 2 * pi) / width;
      return 0.2f * (1 + 0.3f * std::exp(-a * a));
    };
  };
  for (const float width : {0.3f, 0.05f, 0.01f, 0.002f}) {
    BuildOptions options;
    options.albedo_error = 1e-3f, options.one_shot_variance = 0.05f;
    const AnyBrdf f = bump(width);
    try {
      const SamplerData data = build(f, options);
      const auto s = make_sampler(f, data);
      for (const float away : {-1.f, -0.5f, 0.f, 0.4f, 1.f}) {
        const Direction wo = wo_at(50, double(1 + away * width));
        const double truth = pi_v<double> * double(f(shading_geometry(wo, {0, 0, 1}))[0]);
        EXPECT_NEAR(double(s.exact.albedo(wo)) / truth, 1, double(data.albedo.relative_error)) << width;
      }
    } catch (const Error& error) {
      EXPECT_LT(width, 0.005f) << error.what();
      EXPECT_NE(std::string(error.what()).find("phi_o"), std::string::npos) << error.what();
    }
  }
}

// A smooth function whose period hides from few rows.
TEST(ViewerSteps, ManyPeriodsAreSeen) {
  const AnyBrdf f = [](Direction wo, Direction) {
    return 0.2f * (1 + 0.3f * std::cos(16 * std::atan2(wo.y, wo.x)) * (wo.x * wo.x + wo.y * wo.y));
  };
  const SamplerData data = build(f);
  const auto s = make_sampler(f, data);
  for (int i = 0; i < 50; ++i) {
    const Direction wo = wo_at(1 + 1.7 * i, 0.37 * i);
    const double truth = pi_v<double> * double(f(shading_geometry(wo, {0, 0, 1}))[0]);
    EXPECT_NEAR(double(s.exact.albedo(wo)) / truth, 1, double(data.albedo.relative_error)) << i;
  }
}

// Three rings of 1, 6 and 8 patches, any values.
KlemsTable patches() {
  KlemsTable table;
  table.incident = table.exiting = KlemsBasis({0, 0.2, 0.8, pi_v<double> / 2}, {1, 6, 8});
  Pcg32 u(3);
  for (int i = 0; i < 15 * 15; ++i) table.values.push_back(0.05f + 0.5f * to_unit_float(u()));
  return table;
}
TEST(ViewerSteps, PatchesOfViewersAreExact) {
  const KlemsTable table = patches();
  const AnyBrdf f = table;
  const SamplerData data = build(f);
  EXPECT_FALSE(data.frame.isotropic());
  EXPECT_LE(data.albedo.relative_error, 1.001e-4f);
  EXPECT_LE(data.report.expected_trials, 1.25f);
  EXPECT_LE(data.exact.size(), 20U);
  const auto s = make_sampler(f, data);
  Pcg32 u(4);
  for (int i = 0; i < 2000; ++i) {
    const Direction wo = wo_at(89.5 * to_unit_double(u()), 6.2831853 * to_unit_double(u()));
    const double told = table.traits().albedo(wo);
    EXPECT_NEAR(double(s.exact.albedo(wo)) / told, 1, 1e-5) << i;
  }
  // A hair's breadth on either side of a ring and of a patch.
  for (const double away : {-1e-6, 1e-6}) {
    for (const Direction wo :
         {wo_at((0.8 + away) * 180 / pi_v<double>, 2), wo_at(60, pi_v<double> * 0.125 + 5 * away)})
      EXPECT_NEAR(double(s.exact.albedo(wo)) / table.traits().albedo(wo), 1, 1e-5) << away;
  }
  for (const double theta : {5., 30., 70.}) {
    const auto results = judge(s, target_function(f), wo_at(theta, 2), 200'000);
    EXPECT_TRUE(all_passed(results)) << theta << '\n' << to_text(results);
  }
}

// Azimuths go round at a border of patches: three of them in a ring of viewers meet at azimuth 0.
TEST(ViewerSteps, PatchesThatMeetWhereAzimuthsGoRound) {
  KlemsTable table;
  table.incident = KlemsBasis({0, 0.6, pi_v<double> / 2}, {1, 3});
  table.exiting = KlemsBasis({0, 0.8, pi_v<double> / 2}, {1, 4});
  Pcg32 u(6);
  for (int i = 0; i < 4 * 5; ++i) table.values.push_back(0.02f + sqr(to_unit_float(u())));
  const AnyBrdf f = table;
  const SamplerData data = build(f);
  EXPECT_LE(data.report.expected_trials, 1.25f);
  EXPECT_EQ(data.report.overshoot_mass, 0);
  const auto s = make_sampler(f, data);
  for (const double phi : {1e-4, 0.1, 6.1, 6.2831}) {
    const Direction wo = wo_at(60, phi);
    EXPECT_NEAR(double(s.exact.albedo(wo)) / table.traits().albedo(wo), 1, 1e-5) << phi;
  }
}

// The builder's pairs stand at azimuth 0. Beside a step there f takes on all of its values, and turns show nothing.
TEST(ViewerSteps, AStepAtAzimuthZeroIsSeen) {
  const AnyBrdf f = [](Direction wo, Direction) { return wo.y > 0 ? 0.3f : 0.1f; };
  const SamplerData data = build(f);
  EXPECT_FALSE(data.frame.isotropic());
  EXPECT_LE(data.report.expected_trials, 1.25f);
  const auto s = make_sampler(f, data);
  for (const double phi : {0.1, 3., 3.3, 6.1})
    EXPECT_NEAR(double(s.exact.albedo(wo_at(50, phi))) / pi_v<double>, phi < 3.14 ? 0.3 : 0.1, 1e-4) << phi;
}

// A few narrow patches hold most of the light: between the points of a grid they hide.
KlemsTable narrow_patches() {
  KlemsTable table;
  table.incident = KlemsBasis({0, 0.5, pi_v<double> / 2}, {1, 4});
  table.exiting = KlemsBasis({0, 0.1, 0.7, 0.72, 1.3, 1.31, pi_v<double> / 2}, {1, 8, 30, 24, 50, 12});
  Pcg32 u(8);
  for (int i = 0; i < 5 * 125; ++i) table.values.push_back(u() % 16 ? 0.02f : 2 * to_unit_float(u()));
  return table;
}
SampleStatistics trials_of(const AnyBrdf& f, const SamplerData& data) {
  const auto s = make_sampler(f, data);
  SampleStatistics statistics;
  Pcg32 u(9);
  for (int i = 0; i < 300'000; ++i)
    s.exact.sample(wo_at(89.9 * to_unit_double(u()), 6.2831853 * to_unit_double(u())), u, statistics);
  return statistics;
}
TEST(ViewerSteps, ABoundOverPatchesIsNeverExceeded) {
  const AnyBrdf f = narrow_patches();
  const SamplerData data = build(f);
  EXPECT_LE(data.report.expected_trials, 1.25f);
  EXPECT_EQ(data.report.overshoot_mass, 0);
  EXPECT_EQ(trials_of(f, data).overshoots, 0U);
  EXPECT_TRUE(data.report.notes.empty()) << data.report.notes.front();
  // What a patch holds is known: no cubature need judge.
  const KlemsTable table = narrow_patches();
  const auto s = make_sampler(f, data);
  const Direction wo = wo_at(50, 1);
  const int in = table.incident.patch_of({-wo.x, -wo.y, wo.z}), n = 200'000;
  std::vector<int> drawn(125, 0);
  Pcg32 u(10);
  for (int i = 0; i < n; ++i) ++drawn[std::size_t(table.exiting.patch_of(s.exact.sample(wo, u)->wi))];
  double chi_square = 0;
  for (int k = 0; k < 125; ++k) {
    const double mass = double(table.value(in, k)) * table.exiting.projected_solid_angle(k);
    const double mean = n * mass / table.traits().albedo(wo);
    chi_square += std::pow(drawn[std::size_t(k)] - mean, 2) / mean;
  }
  EXPECT_LT(chi_square, 240);  // 124 degrees of freedom: 1e-9
}
// The judge can fail: bounds that are two percent too low.
TEST(ViewerStepsTwin, BoundsOverPatchesTooLow) {
  const AnyBrdf f = narrow_patches();
  SamplerData data = build(f);
  for (MajorantTree& tree : data.exact) tree.volume *= 0.98f;
  EXPECT_GT(trials_of(f, data).overshoots, 1000U);
}
// Patches that are not those of the function.
struct WrongPatches : KlemsTable {
  BrdfTraits traits() const {
    BrdfTraits t = KlemsTable::traits();
    t.patches[1].phi_i.pop_back();
    return t;
  }
};
TEST(ViewerStepsTwin, PatchesToldWrongly) {
  try {
    build(AnyBrdf(WrongPatches{narrow_patches()}));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("constant over patches"), std::string::npos) << error.what();
  }
}

// An albedo that a function tells wrongly is not believed.
struct WrongAboutItself : KlemsTable {
  BrdfTraits traits() const {
    BrdfTraits t = KlemsTable::traits();
    t.albedo = [right = t.albedo](Direction wo) { return 1.05 * right(wo); };
    return t;
  }
};
TEST(ViewerStepsTwin, AnAlbedoToldWrongly) {
  EXPECT_THROW(build(AnyBrdf(WrongAboutItself{patches()})), Error);
}

// Noise over viewers and directions, of twelve rotations of the sample: nothing that any tree could resolve.
SpecularTable<float> noise() {
  SpecularTable<float> table;
  for (int k = 0; k <= 12; ++k)
    table.axes.rotation.push_back(float(k) * pi / 6), table.axes.azimuth.push_back(float(k) * pi / 6);
  table.axes.theta_o = {0.2f, 0.7f, 1.2f}, table.axes.radial = {0, 0.2f, 0.5f, 1, 2, pi};
  const std::size_t width = 6, circle = 12 * width, slice = 3 * (circle + width);
  Pcg32 u(7);
  for (std::size_t i = 0; i < table.axes.size(); ++i) {
    const float a = to_unit_float(u());
    table.values.push_back(0.02f + a * a * a * (i % width < 2 ? 4.f : 0.5f));
    if (i % (circle + width) >= circle) table.values[i] = table.values[i - circle];  // circles close
    if (i / slice == 12) table.values[i] = table.values[i % slice];
  }
  return table;
}
// Whoever comes first may not take all: before the budget was shared the worst slab took 120 trials.
TEST(ViewerSteps, ASmallBudgetIsSharedAmongSlabs) {
  const AnyBrdf f = noise();
  BuildOptions options;
  options.max_evaluations = 8'000'000;
  const SamplerData data = build(f, options);
  EXPECT_LT(data.report.expected_trials, 4);
  EXPECT_LE(data.albedo.relative_error, 1.001e-4f);
  EXPECT_FALSE(data.report.notes.empty());
  std::string notes;
  for (const std::string& note : data.report.notes) notes += note + '\n';
  EXPECT_NE(notes.find("trials on average"), std::string::npos) << notes;
  EXPECT_NE(notes.find("bounds of exact mode miss"), std::string::npos) << notes;
  const auto s = make_sampler(f, data);
  for (const double theta : {20., 55., 80.}) {
    const auto wo = wo_at(theta, theta);
    const Bins bins = equal_mass_bins(target_function(f), wo);
    EXPECT_NEAR(double(s.exact.albedo(wo)) / bins.total, 1, 1e-4 + bins.worst_error) << theta;
  }
}

}  // namespace
}  // namespace reflectree
