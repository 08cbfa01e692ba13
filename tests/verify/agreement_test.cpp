// SPDX-License-Identifier: Apache-2.0
// Direction by direction at many elevations: agreement and the way back, with their twins.
#include "reflectree/verify/agreement.hpp"

#include <cmath>

#include "reflectree/verify/faults.hpp"
#include "simple_samplers.hpp"
#include "suspects.hpp"

namespace reflectree {
namespace {

constexpr float degree = pi / 180;

std::vector<Direction> many_viewers() {
  std::vector<Direction> viewers;
  for (int i = 0; i < 60; ++i) viewers.push_back(direction_at(1.5 * i + 0.3, 37 * i));
  return viewers;
}
// Either side of the borders of one-shot slabs.
std::vector<Direction> border_viewers() {
  std::vector<Direction> viewers;
  for (const float c : built().sampler.exact.packed().one_shot.lookup.borders()) {
    if (!(c > 1e-4f && c < 1)) continue;
    for (const float side : {1 - 4e-7f, 1 + 4e-7f}) {
      const float z = c * side;
      viewers.push_back({std::sqrt(1 - z * z), 0, z});
    }
  }
  return viewers;
}
Suspect with_ways(Suspect s, const std::function<WayIn(WayIn)>& spoil) {
  for (WayIn& w : s.ways) w = spoil(std::move(w));
  return s;
}
std::vector<CheckResult> judge(const Suspect& s) { return check_agreement(s, many_viewers()); }

TEST(Agreement, OfASoundSampler) {
  expect_all_pass(judge(built().suspect()));
  expect_all_pass(check_agreement(built().suspect(), border_viewers()));
  const CheckResult trip = check_round_trip(built().suspect(), many_viewers());
  EXPECT_TRUE(trip.passed) << to_line(trip);
}

TEST(AgreementTwin, PdfWeightAndChannels) {
  const Suspect s = built().suspect();
  EXPECT_TRUE(
      fails(judge(with_ways(s, [](WayIn w) { return scaled_pdf(std::move(w), 1.01f); })), "pdf_agrees"));
  const auto weights = judge(with_ways(s, [](WayIn w) { return scaled_weight(std::move(w), 1.01f); }));
  EXPECT_TRUE(fails(weights, "weight_agrees"));
  EXPECT_TRUE(fails(weights, "target"));
  const auto exchanged = judge(with_ways(s, [](WayIn w) {
    return spoiled(std::move(w), "exchanged",
                   [](Direction, Pcg32&, DrawnAt&, std::span<float> c) { std::swap(c[0], c[1]); });
  }));
  EXPECT_TRUE(fails(exchanged, "weight_agrees"));
  EXPECT_FALSE(fails(exchanged, "target")) << "the norm does not see it";
  const auto broken = judge(with_ways(s, [](WayIn w) {
    return spoiled(std::move(w), "broken", [](Direction, Pcg32& u, DrawnAt&, std::span<float> c) {
      if (u() % 1000 == 0) c[1] = NAN;
    });
  }));
  EXPECT_TRUE(fails(broken, "finite"));
}

TEST(AgreementTwin, ADensityThatLostItsSupport) {
  Suspect s = built().suspect();
  s.one_shot_pdf = [inner = s.one_shot_pdf](Direction wo, Direction wi) {
    return wi.z > 0.97f ? 0.f : inner(wo, wi);
  };
  EXPECT_TRUE(fails(judge(s), "support"));
}

// Between two elevations that a fixed list of five would visit.
TEST(AgreementTwin, FivePerCentBetween41And46Degrees) {
  Suspect s = built().suspect();
  s.one_shot_pdf = [inner = s.one_shot_pdf](Direction wo, Direction wi) {
    const float theta = theta_of(wo) / degree;
    return (theta > 41 && theta < 46 ? 1.05f : 1.f) * inner(wo, wi);
  };
  EXPECT_TRUE(fails(judge(s), "pdf_agrees"));
}

// The density of a slab that begins at 0.999 of the cosine: wrong beside the borders alone.
TEST(AgreementTwin, TheDensityOfTheSlabBeside) {
  Suspect s = built().suspect();
  const PackedSampler& packed = *s.packed;
  const auto inner = s.one_shot_pdf;
  s.one_shot_pdf = [&packed, inner](Direction wo, Direction wi) {
    const bool other = &packed.one_shot.slab_at(0.999f * wo.z) != &packed.one_shot.slab_at(wo.z);
    return other ? 1.1f * inner(wo, wi) : inner(wo, wi);
  };
  EXPECT_TRUE(fails(check_agreement(s, border_viewers()), "pdf_agrees"));
}

// Drawn by the luminance, though the norm is promised: each direction's weight tells.
TEST(AgreementTwin, LuminanceInPlaceOfTheNorm) {
  BuildOptions luminance;
  luminance.target.kind = TargetKind::luminance;
  const auto sampler = make_sampler(coloured(), luminance);
  Suspect s = suspect_of(sampler);
  EXPECT_FALSE(fails(judge(s), "target"));
  s.target.kind = TargetKind::norm;
  const auto results = judge(s);
  EXPECT_TRUE(fails(results, "target"));
  EXPECT_TRUE(fails(results, "mode_agrees"));
}

TEST(AgreementTwin, AWayBackThatEndsElsewhere) {
  Suspect s = built().suspect();
  const auto inner = s.invert;
  s.invert = [inner](Direction wo, Direction wi) {
    auto p = inner(wo, wi);
    if (p) p->y = 1 - p->y;
    return p;
  };
  EXPECT_FALSE(check_round_trip(s, many_viewers()).passed);
  s.invert = [inner](Direction wo, Direction wi) {
    auto p = inner(wo, wi);
    if (p) p->x *= 0.999;
    return p;
  };
  EXPECT_FALSE(check_round_trip(s, many_viewers()).passed);
  s.invert = [](Direction, Direction) { return std::optional<Vec2<double>>(); };
  EXPECT_FALSE(check_round_trip(s, many_viewers()).passed);
}

}  // namespace
}  // namespace reflectree
