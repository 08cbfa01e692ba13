// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/brdf/models/retro_reflector.hpp"
#include "reflectree/brdf/registry.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/simd/sample_batch.hpp"
#include "reflectree/verify/chi_square.hpp"
#include "reflectree/verify/reference.hpp"

namespace reflectree {
namespace {

// Random directions, with some for which there is no sample.
std::vector<Direction> many_wo(std::size_t n, bool with_bad = true) {
  Pcg32 u(5);
  std::vector<Direction> wo(n);
  for (std::size_t i = 0; i < n; ++i) {
    const float z = 0.002f + 0.998f * to_unit_float(u()), phi = 2 * pi * to_unit_float(u());
    const float s = sqrt(1 - z * z);
    wo[i] = {s * cos(phi), s * sin(phi), with_bad && i % 17 == 3 ? -z : z};
  }
  return wo;
}

template <class Value>
float difference(const DirectionSample<Value>& a, const DirectionSample<Value>& b) {
  float worst = length(a.wi - b.wi);
  worst = max(worst, abs(a.pdf - b.pdf) / max(b.pdf, 1e-30f));
  for (int c = 0; c < channels_of(b.weight); ++c) {
    worst = max(worst, abs(channel(a.weight, c) - channel(b.weight, c)) / max(channel(b.weight, c), 1e-30f));
  }
  return worst;
}

// Samples of the batch that are not those of one-by-one calls with the same bits.
template <class Sampler, class Value>
int unlike(const Sampler& sampler, std::span<const Direction> wo, Pcg32 u,
           std::span<const DirectionSample<Value>> batch) {
  int count = 0;
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const auto one = sampler.sample(wo[i], u);
    count += one ? !(difference(batch[i], *one) < 1e-5f)
                 : batch[i].flags != 0 || batch[i].pdf != 0 || channel(batch[i].weight, 0) != 0;
  }
  return count;
}
template <class Sampler, class Value>
int unlike(const Sampler& sampler, std::span<const Direction> wo, std::span<const Vec2<double>> points,
           std::span<const DirectionSample<Value>> batch) {
  int count = 0;
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const auto one = sampler.sample(wo[i], points[i].x, points[i].y);
    count += one ? !(difference(batch[i], *one) < 1e-5f) : batch[i].flags != 0;
  }
  return count;
}

template <class F>
void expect_one_shot_like_one_by_one(const Sampler<F>& sampler, const std::string& name) {
  using Sample = DirectionSample<ValueOf<F>>;
  for (const std::size_t n : {1UL, 3UL, 64UL, 333UL}) {
    const std::vector<Direction> wo = many_wo(n);
    std::vector<Sample> out(n);
    Pcg32 u(n), same(n);
    sample_batch(sampler.one_shot, wo, u, std::span(out));
    EXPECT_EQ(unlike(sampler.one_shot, wo, same, std::span<const Sample>(out)), 0) << name;
    if (n > 3) {
      std::rotate(out.begin(), out.begin() + 1, out.end());  // the twin: lanes mixed up by one
      EXPECT_GT(unlike(sampler.one_shot, wo, same, std::span<const Sample>(out)), int(n) / 2) << name;
    }
    std::vector<Vec2<double>> points(n);
    for (auto& p : points) p = {to_unit_double(u()), to_unit_double(u())};
    sample_batch(sampler.one_shot, wo, std::span<const Vec2<double>>(points), std::span(out));
    EXPECT_EQ(unlike(sampler.one_shot, wo, points, std::span<const Sample>(out)), 0) << name;
  }
}

TEST(SampleBatch, OneShotIsThatOfOneByOneCalls) {
  expect_one_shot_like_one_by_one(make_sampler(Ggx{0.1f}), "ggx");
  expect_one_shot_like_one_by_one(make_sampler(Lambert{}), "lambert");
  expect_one_shot_like_one_by_one(make_sampler(RetroReflector{}), "retro_reflector");
  // A plain lambda: one by one inside the block.
  const auto lobe = [](Direction wo, Direction wi) { return 1 + dot(wo, wi) * dot(wo, wi); };
  expect_one_shot_like_one_by_one(make_sampler(lobe), "lambda");
}

}  // namespace
}  // namespace reflectree
