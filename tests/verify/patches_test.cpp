// SPDX-License-Identifier: Apache-2.0
// Functions that are constant over patches and tell of them: masses are known, sound samplers pass, faults do not.
#include <gtest/gtest.h>

#include "reflectree/brdf/tables/klems_table.hpp"
#include "reflectree/verify/faults.hpp"
#include "reflectree/verify/reference.hpp"
#include "reflectree/verify/verify.hpp"
#include "reflectree/verify/way_tally.hpp"
#include "simple_samplers.hpp"
#include "suspects.hpp"

namespace reflectree {
namespace {

// Most of the light leaves into a few patches of narrow rings; a third of all patches are dark.
const KlemsTable& matrix() {
  static const KlemsTable table = [] {
    KlemsTable t;
    t.incident = KlemsBasis({0, 0.5, pi_v<double> / 2}, {1, 4});
    t.exiting = KlemsBasis({0, 0.1, 0.7, 0.704, 1.3, 1.303, pi_v<double> / 2}, {1, 8, 30, 24, 50, 12});
    Pcg32 u(8);
    for (int i = 0; i < 5 * 125; ++i) {
      const bool narrow = (i % 125 >= 9 && i % 125 < 39) || (i % 125 >= 63 && i % 125 < 113);
      t.values.push_back(u() % 3 == 0 ? 0 : narrow && u() % 6 == 0 ? 20 * to_unit_float(u()) : 0.02f);
    }
    return t;
  }();
  return table;
}
double mass_of(int in, int out) {
  return double(matrix().value(in, out)) * matrix().exiting.projected_solid_angle(out);
}

struct Made {
  AnyBrdf f = matrix();
  SamplerData data = build(f);
  Sampler<AnyBrdf> sampler = make_sampler(f, data);
};
const Made& made() {
  static const Made m;
  return m;
}

TEST(Patches, BinsLieInPatchesWhoseMassesAreExact) {
  const TargetFunction f = target_function(made().f);
  for (const Direction wo : {direction_at(10, 40), direction_at(60, 100), direction_at(89, 300)}) {
    const int in = matrix().incident.patch_of({-wo.x, -wo.y, wo.z});
    const double albedo = matrix().traits().albedo(wo);
    const Bins bins = equal_mass_bins(f, wo);
    EXPECT_NEAR(bins.total / albedo, 1, 1e-5);
    EXPECT_NEAR(reference_albedo(f, wo).value / albedo, 1, 1e-5);
    EXPECT_LT(bins.worst_error, 1e-5);
    std::vector<double> mass(125, 0);
    double largest = 0;
    for (std::size_t b = 0; b < bins.boxes.size(); ++b) {
      const CubatureBox& r = bins.boxes[b];
      const auto patch_at = [&](double x, double y) {
        const Vec3<double> w = bins.chart.direction({linear_mix(x, r.x0, r.x1), linear_mix(y, r.y0, r.y1)}).w;
        const Direction wi{float(w.x), float(w.y), float(w.z)};
        EXPECT_EQ(bins.find(wi), b);
        return matrix().exiting.patch_of(wi);
      };
      const int patch = patch_at(0.5, 0.5);
      if (mass_of(in, patch) > 0) {
        for (const double x : {0.02, 0.98}) {
          EXPECT_EQ(patch_at(x, 0.02), patch);
          EXPECT_EQ(patch_at(x, 0.98), patch);
        }
      }
      mass[std::size_t(patch)] += bins.mass[b];
      largest = std::max(largest, bins.mass[b]);
    }
    for (int k = 0; k < 125; ++k) EXPECT_NEAR(mass[std::size_t(k)], mass_of(in, k), 2e-5 * albedo) << k;
    EXPECT_LT(largest, 2 * albedo / 400);
  }
}
// Without them cubature misses some, and says so or not.
TEST(PatchesTwin, CubatureAloneMissesNarrowOnes) {
  TargetFunction f = target_function(made().f);
  f.patches.clear();
  double worst = 0;
  for (int i = 0; i < 12; ++i) {
    const Direction wo = direction_at(7 * i + 3, 29 * i);
    worst = std::max(worst, std::abs(equal_mass_bins(f, wo).total / matrix().traits().albedo(wo) - 1));
  }
  EXPECT_GT(worst, 3e-4);
}
// Patches told wrongly: cubature goes on halving, and finds the truth all the same.
TEST(Patches, ToldWronglyTheyAreNotBelieved) {
  const TargetFunction right = target_function(AnyBrdf(KlemsTable(matrix())));
  TargetFunction wrong = right;
  for (PatchBand& band : wrong.patches) {
    for (float& phi : band.phi_i) phi += 0.05f;
  }
  const Direction wo = direction_at(60, 100);
  const double albedo = matrix().traits().albedo(wo);
  EXPECT_NEAR(reference_albedo(wrong, wo).value / albedo, 1, 2e-3);
  EXPECT_NE(reference_albedo(wrong, wo).value, reference_albedo(right, wo).value);
}

VerifyOptions some() {
  VerifyOptions options;
  options.theta_o_deg = {70};
  options.random_elevations = 1;
  options.effort = 0.1;
  options.albedo_directions = 24;
  return options;
}
VerifyReport judged(const SamplerData& data) {
  const Sampler<AnyBrdf> sampler = make_sampler(made().f, data);
  return verify(sampler, &data, some());
}

TEST(Patches, ASoundSamplerPasses) { expect_all_pass(judged(made().data).checks); }
TEST(PatchesTwin, ASlabWithItsNeighboursTree) {
  SamplerData data = made().data;
  std::rotate(data.exact.begin(), data.exact.begin() + 1, data.exact.end());
  EXPECT_TRUE(fails(judged(data).checks, "overshoot_mass"));
}
TEST(PatchesTwin, AFrameTurnedByOneDegree) {
  SamplerData data = made().data;
  data.frame.axis += pi / 180;
  EXPECT_TRUE(fails(judged(data).checks, "overshoot_mass"));
}

// What was drawn, rewritten: at one viewer, by the way of exact mode and that of one-shot mode.
std::vector<CheckResult> judged_where(const Spoil& spoil, std::size_t way,
                                      Direction wo = direction_at(60, 100)) {
  const Suspect s = suspect(made().sampler, made().f, &made().data);
  const Bins bins = equal_mass_bins(target_function(s.f), wo);
  ChiSquareOptions options;
  options.tests = 200;
  const WayTally tally = tally_of(s, spoiled(s.ways[way], "spoiled", spoil), bins, 1'000'000, 5);
  std::vector<CheckResult> results{check_weights(tally, bins, options),
                                   check_mean_weight(tally, bins, options, 2e-4)};
  if (s.ways[way].exact) results.push_back(check_counts(tally, bins, options));
  return results;
}
constexpr std::size_t exact = 0, one_shot = 3;

TEST(Patches, BothModesDrawWhatPatchesHold) {
  for (const std::size_t way : {exact, one_shot}) {
    expect_all_pass(judged_where([](Direction, Pcg32&, DrawnAt&, std::span<float>) {}, way));
  }
}
TEST(PatchesTwin, DirectionsTurnedByOneDegree) {
  const auto turned = [](Direction, Pcg32&, DrawnAt& d, std::span<float>) {
    const float c = std::cos(pi / 180), s = std::sin(pi / 180);
    d.wi = {c * d.wi.x - s * d.wi.y, s * d.wi.x + c * d.wi.y, d.wi.z};
  };
  EXPECT_TRUE(fails(judged_where(turned, exact), "chi_square"));
  EXPECT_TRUE(fails(judged_where(turned, one_shot), "chi_square_weights"));
}
// One bright patch leads into its mirror image, of the same value and measure or not.
TEST(PatchesTwin, HalvesOfAPatchExchanged) {
  const auto folded = [](Direction, Pcg32& u, DrawnAt& d, std::span<float>) {
    if (matrix().exiting.patch_of(d.wi) == 4 && d.wi.y > 0 && u() % 4 == 0) d.wi.y *= -1;
  };
  EXPECT_TRUE(fails(judged_where(folded, exact), "chi_square"));
}
TEST(PatchesTwin, AWrongWeight) {
  for (const std::size_t way : {exact, one_shot}) {
    const auto heavier = [](Direction, Pcg32&, DrawnAt&, std::span<float> w) { w[0] *= 1.003f; };
    EXPECT_TRUE(fails(judged_where(heavier, way), "mean_weight"));
    // Of single patches, the mean hardly changes.
    const auto exchanged = [](Direction, Pcg32&, DrawnAt& d, std::span<float> w) {
      w[0] *= matrix().exiting.patch_of(d.wi) % 2 ? 1.03f : 0.97f;
    };
    EXPECT_TRUE(fails(judged_where(exchanged, way), "chi_square_weights"));
  }
}

}  // namespace
}  // namespace reflectree
