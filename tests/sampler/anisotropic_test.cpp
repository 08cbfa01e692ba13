// SPDX-License-Identifier: Apache-2.0
// Functions that depend on the azimuth of wo: what is drawn is f in its own frame, for every viewer.
#include <gtest/gtest.h>

#include <algorithm>

#include "functions.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "reflectree/simd/sample_batch.hpp"

namespace reflectree {
namespace {

struct Built {
  AnyBrdf f;
  SamplerData data;
  Sampler<AnyBrdf> sampler;
};
Built built(const AnyBrdf& f, const BuildOptions& options = {}) {
  SamplerData data = build(f, options);
  Sampler<AnyBrdf> sampler = make_sampler(f, data);
  return {f, std::move(data), std::move(sampler)};
}
const Built& metal() {
  static const Built b = built(material("ggx:alpha_x=0.1,alpha_y=0.3,phi_deg=20"));
  return b;
}

// Viewers all over the hemisphere, some near grazing.
std::vector<Direction> viewers(std::uint64_t seed, int count) {
  Pcg32 u(seed);
  std::vector<Direction> wo;
  for (int i = 0; i < count; ++i)
    wo.push_back(wo_at(i % 4 == 3 ? 89 : 88 * to_unit_double(u()), 6.2831853 * to_unit_double(u())));
  return wo;
}

::testing::AssertionResult draws_f(const AnyBrdf& f, const Sampler<AnyBrdf>& s, std::uint64_t seed,
                                   int count = 5) {
  for (const Direction wo : viewers(seed, count)) {
    const auto results = judge(s, target_function(f), wo, 200'000);
    if (!all_passed(results)) {
      return ::testing::AssertionFailure() << theta_of(wo) << ' ' << std::atan2(wo.y, wo.x) << '\n'
                                           << to_text(results);
    }
  }
  return ::testing::AssertionSuccess();
}

TEST(Anisotropic, MetalInItsOwnFrame) {
  const Built& b = metal();
  EXPECT_EQ(b.data.frame.symmetry, ViewerSymmetry::two_planes);
  EXPECT_EQ(b.data.domain.kind, DomainKind::slope_star);
  const float axis = b.data.frame.axis * 180 / pi;  // of the wider lobe, y
  EXPECT_NEAR(std::remainder(double(axis) - 110, 180.), 0, 1e-3);
  EXPECT_LE(b.data.report.expected_trials, 1.25f);
  EXPECT_LE(b.data.albedo.relative_error, 1.001e-4f);
  EXPECT_TRUE(b.data.report.notes.empty());
  EXPECT_LT(bytes_of(pack(b.data)), 512U * 1024);
  EXPECT_TRUE(draws_f(b.f, b.sampler, 1));
}

// What f is may not change at a border of what is folded: the same pair, mirrored or turned about the frame.
TEST(Anisotropic, ValuesAreThoseOfTheCallersFrame) {
  const Built& b = metal();
  Pcg32 u(3);
  for (const Direction wo : viewers(5, 40)) {
    const auto s = b.sampler.exact.sample(wo, u);
    ASSERT_TRUE(s);
    const Spectrum f = b.f(shading_geometry(wo, s->wi));
    const float albedo = b.sampler.exact.albedo(wo), t = b.data.target(f.data(), 3);
    EXPECT_NEAR(double(s->pdf), double(t * s->wi.z / albedo), 1e-4 * double(s->pdf));
    EXPECT_NEAR(double(b.sampler.exact.pdf(wo, s->wi)), double(s->pdf), 1e-4 * double(s->pdf));
    const auto q = b.sampler.one_shot.sample(wo, 0.3, 0.6);
    ASSERT_TRUE(q);
    EXPECT_NEAR(double(b.sampler.one_shot.pdf(wo, q->wi)), double(q->pdf), 2e-3 * double(q->pdf));
    const auto place = b.sampler.one_shot.invert(wo, q->wi);
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->x, 0.3, 1e-3);
    EXPECT_NEAR(place->y, 0.6, 1e-3);
  }
}

TEST(Anisotropic, BatchesDrawWhatOneByOneDraws) {
  const Built& b = metal();
  const std::vector<Direction> wo = viewers(9, 200);
  std::vector<DirectionSample<Spectrum>> out(wo.size());
  Pcg32 one(7), many(7);
  sample_batch(b.sampler.one_shot, wo, many, out);
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const auto s = b.sampler.one_shot.sample(wo[i], one);
    ASSERT_TRUE(s);
    EXPECT_EQ(s->wi, out[i].wi) << i;
    EXPECT_EQ(s->pdf, out[i].pdf) << i;
  }
}

TEST(Anisotropic, SurvivesAFile) {
  const Built& b = metal();
  const SamplerData again = decode_sampler(encode_sampler(b.data), "memory");
  EXPECT_EQ(again, b.data);
}

// The table is not only what cubature says at its nodes.
TEST(Anisotropic, AlbedoBetweenItsNodes) {
  const Built& b = metal();
  for (const Direction wo : viewers(21, 12)) {
    const Bins bins = equal_mass_bins(target_function(b.f), wo);
    EXPECT_NEAR(double(b.sampler.exact.albedo(wo)) / bins.total, 1, 1e-4 + bins.worst_error) << theta_of(wo);
  }
}

// Two lobes that are turned against each other and a lopsided one: nothing to fold.
struct NoSymmetry {
  float operator()(Direction wo, Direction wi) const {
    const Direction h = normalize(wo + wi);
    const auto lobe = [&](float phi, float ax, float ay) {
      const float c = std::cos(phi), s = std::sin(phi), x = (c * h.x + s * h.y) / ax,
                  y = (c * h.y - s * h.x) / ay;
      return std::exp(-(x * x + y * y) / (h.z * h.z));
    };
    return 0.1f + 0.05f * wi.x + 0.5f * lobe(0.4f, 0.3f, 0.8f) + 0.3f * lobe(1.5f, 0.6f, 0.4f);
  }
};
TEST(Anisotropic, WithoutAnySymmetry) {
  BuildOptions options;
  options.expected_trials = 2, options.one_shot_variance = 0.2f, options.albedo_error = 1e-3f;
  const Built b = built(NoSymmetry{}, options);
  EXPECT_EQ(b.data.frame.symmetry, ViewerSymmetry::none);
  EXPECT_TRUE(draws_f(b.f, b.sampler, 2));
}

TEST(Anisotropic, HalfATurnAndOnePlane) {
  BuildOptions options;
  options.expected_trials = 1.5f, options.one_shot_variance = 0.05f, options.albedo_error = 1e-3f;
  const Built half = built(
      [](Direction wo, Direction wi) { return 0.2f + 0.1f * wo.x * wi.y + 0.05f * wi.x * wi.x; }, options);
  EXPECT_EQ(half.data.frame.symmetry, ViewerSymmetry::half_turn);
  EXPECT_TRUE(draws_f(half.f, half.sampler, 3, 4));
  const Built plane = built([](Direction, Direction wi) { return 0.2f + 0.15f * wi.x; }, options);
  EXPECT_EQ(plane.data.frame.symmetry, ViewerSymmetry::one_plane);
  EXPECT_TRUE(draws_f(plane.f, plane.sampler, 4, 4));
}

// Excess of T / a over the bounds, per trial, over viewers everywhere.
double overshoot_of(const Sampler<AnyBrdf>& s) {
  SampleStatistics statistics;
  Pcg32 u(17);
  for (const Direction wo : viewers(41, 2000)) {
    for (int i = 0; i < 100; ++i) s.exact.sample(wo, u, statistics);
  }
  return statistics.overshoot_sum / double(statistics.trials);
}
TEST(Anisotropic, BoundsHold) { EXPECT_LT(overshoot_of(metal().sampler), 1e-6); }

// Planted faults: rejection and weights hide those that only bend a tree; the bounds tell.
bool is_seen(const AnyBrdf& f, const SamplerData& data) {
  const auto s = make_sampler(f, data);
  return overshoot_of(s) > 1e-5 || !draws_f(f, s, 31, 8);
}

TEST(AnisotropicTwin, ASlabWithItsNeighboursTree) {
  SamplerData data = metal().data;
  std::rotate(data.exact.begin(), data.exact.begin() + 1, data.exact.end());
  std::rotate(data.one_shot.begin(), data.one_shot.begin() + 1, data.one_shot.end());
  EXPECT_TRUE(is_seen(metal().f, data));
}
TEST(AnisotropicTwin, AnAxisOneDegreeOff) {
  SamplerData data = metal().data;
  data.frame.axis += pi / 180;
  EXPECT_TRUE(is_seen(metal().f, data));
}
TEST(AnisotropicTwin, AMirrorPlaneThatIsNone) {
  const AnyBrdf f = [](Direction wo, Direction wi) { return 0.2f + 0.18f * wo.x * wi.y; };
  BuildOptions options;
  options.expected_trials = 1.1f, options.one_shot_variance = 0.05f, options.albedo_error = 1e-3f;
  SamplerData data = build(f, options);
  ASSERT_EQ(data.frame.symmetry, ViewerSymmetry::half_turn);
  data.frame.symmetry = ViewerSymmetry::one_plane, data.albedo.even = true;
  EXPECT_TRUE(is_seen(f, data));
}
TEST(AnisotropicTwin, AStretchThatIsNotTheTrees) {
  SamplerData data = metal().data;
  data.domain.stretch *= 1.05f;
  EXPECT_TRUE(is_seen(metal().f, data));
}

}  // namespace
}  // namespace reflectree
