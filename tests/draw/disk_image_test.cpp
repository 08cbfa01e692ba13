// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/disk_image.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/error.hpp"
#include "toy_sampler.hpp"

namespace reflectree::draw {
namespace {

// Over projected solid angle: the disk has area pi.
double integral(const DiskImage& image) {
  double sum = 0;
  for (const float v : image.value) sum += std::isnan(v) ? 0 : double(v);
  return sum * 4 / (double(image.size) * image.size);
}

TEST(DiskImage, LambertIsConstantAndAbsentOutside) {
  const DiskImage image = target_image(Lambert{{0.5f, 0.5f, 0.5f}}, {}, viewer_at(0.7f), 64);
  const float expected = 0.5f / pi * std::sqrt(3.f);
  EXPECT_NEAR(image.at(0, 0), expected, 1e-6f);
  EXPECT_NEAR(image.at(0.6, -0.7), expected, 1e-6f);
  EXPECT_TRUE(std::isnan(image.value.front()));
}

TEST(DiskImage, AxesPointRightAndUp) {
  const auto f = [](Direction, Direction wi) { return (wi.x > 0 ? 2.f : 1.f) + (wi.y > 0 ? 4.f : 0.f); };
  const DiskImage image = target_image(AnyBrdf(f), {}, viewer_at(0.f), 64);
  EXPECT_EQ(image.at(0.5, 0.5), 6);
  EXPECT_EQ(image.at(-0.5, 0.5), 5);
  EXPECT_EQ(image.at(-0.5, -0.5), 1);
  EXPECT_EQ(image.value[16 * 64 + 48], 6);  // upper right quarter of the picture
}

TEST(LogRange, AtLeastADecadeAtMostFive) {
  DiskImage image{2, {1, 1, 1, std::nanf("")}};
  const Axis flat = log_range(image);
  EXPECT_NEAR(flat.hi / flat.lo, 10, 1e-9);
  EXPECT_NEAR(flat.at(1), 0.5, 1e-9);
  image.value = {1e-9f, 0, 100, 1};
  const Axis wide = log_range(image);
  EXPECT_NEAR(wide.hi, 100, 1e-9);
  EXPECT_NEAR(wide.lo, 1e-3, 1e-9);
}

class TreeImages : public testing::TestWithParam<DomainKind> {};

TEST_P(TreeImages, BoundsLieAboveTheTargetAndHoldTheVolume) {
  const AnyBrdf f = Ggx{0.4f, {1.f, 0.8f, 0.3f}};
  const bool stretched = GetParam() == DomainKind::stretched;
  const SamplerData data =
      toy_sampler(f,
                  {GetParam(), GetParam() != DomainKind::equal_area ? Symmetry::mirror : Symmetry::none,
                   stretched ? 1.2f : 0.f},
                  8);
  const Direction wo = viewer_at(0.5f);
  const DiskImage target = target_image(f, {}, wo, 128), bound = bound_image(data, wo, 128);
  int below = 0, pixels = 0;
  for (std::size_t i = 0; i < target.value.size(); ++i) {
    if (std::isnan(target.value[i])) continue;
    ++pixels;
    below += bound.value[i] < target.value[i];
  }
  EXPECT_LT(below, pixels / 200);  // the toy's maxima are sampled
  const double albedo = double(albedo_at(data.albedo, wo.z)), volume = double(data.exact[0].volume);
  EXPECT_NEAR(integral(bound) / (albedo * volume), 1, 0.05);
  EXPECT_NEAR(integral(target) / albedo, 1, 0.05);
  EXPECT_NEAR(integral(one_shot_image(data, wo, 128)) / albedo, 1, 0.05);
}

TEST_P(TreeImages, HalvedMassesAreSeenBelowTheTarget) {
  const AnyBrdf f = Ggx{0.4f, {1.f, 0.8f, 0.3f}};
  SamplerData data =
      toy_sampler(f, {GetParam(), Symmetry::mirror, GetParam() == DomainKind::stretched ? 1.2f : 0.f}, 8);
  data.exact[0].volume *= 0.5f;
  const Direction wo = viewer_at(0.5f);
  const DiskImage target = target_image(f, {}, wo, 128), bound = bound_image(data, wo, 128);
  int below = 0, pixels = 0;
  for (std::size_t i = 0; i < target.value.size(); ++i) {
    pixels += !std::isnan(target.value[i]);
    below += bound.value[i] < target.value[i];
  }
  EXPECT_GT(below, pixels / 20);
}

TEST(TreeImage, ASlopeTiltsTheLeaf) {
  const AnyBrdf f = Lambert{};
  SamplerData data = toy_sampler(f, {DomainKind::projected_disk, Symmetry::mirror, 0}, 0);
  const Direction wo = viewer_at(0.5f);
  const DiskImage flat = bound_image(data, wo, 64);
  data.exact[0].slope_x[0] = 64;
  data.one_shot[0].slope_y[0] = -64;
  const DiskImage tilted = bound_image(data, wo, 64), other = one_shot_image(data, wo, 64);
  // x is the azimuth: 1 towards the viewer, 0 aside, -1 away; y = sin^2 theta_i.
  EXPECT_NEAR(flat.at(-0.9, 0.01) / flat.at(0.9, 0.01), 1, 1e-4);
  EXPECT_NEAR(tilted.at(0.9, 0.01) / flat.at(0.9, 0.01), 1.5, 0.02);
  EXPECT_NEAR(tilted.at(-0.9, 0.01) / flat.at(-0.9, 0.01), 0.5, 0.02);
  EXPECT_NEAR(tilted.at(0.01, 0.9) / flat.at(0.01, 0.9), 1, 0.02);
  EXPECT_NEAR(other.at(0.01, 0.01) / other.at(-0.9, 0.3), 1.5 / (1.5 - 0.9), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Domains, TreeImages,
                         testing::Values(DomainKind::projected_disk, DomainKind::equal_area,
                                         DomainKind::half_vector, DomainKind::back_vector,
                                         DomainKind::stretched, DomainKind::mirror_vector,
                                         DomainKind::normal_vector));

}  // namespace
}  // namespace reflectree::draw
