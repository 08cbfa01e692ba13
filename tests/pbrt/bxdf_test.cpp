// SPDX-License-Identifier: Apache-2.0
// The BxDF for pbrt, judged by the doctor over a stand-in for pbrt's headers; and twins that it must reject.
#include <gtest/gtest.h>

#include <memory>

#include "reflectree/verify/doctor.hpp"
#include "reflectree_bxdf.h"

using namespace reflectree;

namespace {

using OwnedSampler = std::unique_ptr<reflectree_sampler, void (*)(reflectree_sampler*)>;
OwnedSampler built(reflectree_function* f) {
  reflectree_sampler* s = nullptr;
  EXPECT_EQ(reflectree_build(f, nullptr, &s), REFLECTREE_OK) << reflectree_last_error();
  reflectree_function_free(f);
  return {s, reflectree_sampler_free};
}
OwnedSampler built(const char* material) {
  reflectree_function* f = nullptr;
  EXPECT_EQ(reflectree_function_open(material, nullptr, &f), REFLECTREE_OK) << reflectree_last_error();
  return built(f);
}

int matt(void*, std::size_t n, const float*, const float*, float* values) {
  std::fill_n(values, n, 0.08f);
  return 0;
}

pbrt::Vector3f theirs(Direction w, int side) { return {w.x, w.y, float(side) * w.z}; }

// pbrt::ReflectreeBxDF from one side, as the doctor asks.
Patient patient_of(pbrt::ReflectreeBxDF bxdf, int side, float pdf_factor = 1) {
  using pbrt::BxDFReflTransFlags;
  using pbrt::TransportMode;
  Patient p;
  p.channels = 3;
  p.eval = [=](std::span<const Direction> wo, std::span<const Direction> wi, std::span<double> out) {
    for (std::size_t i = 0; i < wo.size(); ++i) {
      const auto f = bxdf.f(theirs(wo[i], side), theirs(wi[i], side), TransportMode::Radiance);
      for (int c = 0; c < 3; ++c) out[3 * i + std::size_t(c)] = double(f[c]);
    }
  };
  p.value_kind = ValueKind::f;
  p.sample = [=](std::span<const Direction> wo, std::uint64_t seed, std::span<PatientDraw> draws,
                 std::span<double> values) {
    Pcg32 u(seed, 5);
    const auto number = [&] { return to_unit_float(u()); };
    for (std::size_t i = 0; i < wo.size(); ++i) {
      const float choice = number(), x = number(), y = number();
      const auto s = bxdf.Sample_f(theirs(wo[i], side), choice, {x, y}, TransportMode::Radiance,
                                   BxDFReflTransFlags::All);
      draws[i] = {};
      if (s) draws[i] = {{s->wi.x, s->wi.y, float(side) * s->wi.z}, double(s->pdf), true};
      for (int c = 0; c < 3; ++c) values[3 * i + std::size_t(c)] = s ? double(s->f[c]) : 0;
    }
  };
  p.pdf = [=](std::span<const Direction> wo, std::span<const Direction> wi, std::span<double> out) {
    for (std::size_t i = 0; i < wo.size(); ++i) {
      out[i] = double(bxdf.PDF(theirs(wo[i], side), theirs(wi[i], side), TransportMode::Radiance,
                               BxDFReflTransFlags::All));
      out[i] *= wi[i].y > 0 ? double(pdf_factor) : 1;
    }
  };
  return p;
}

DoctorOptions quick() { return doctor_options(DoctorEffort::quick); }

constexpr pbrt::ReflectreeMode modes[] = {pbrt::ReflectreeMode::Monotone, pbrt::ReflectreeMode::Alias,
                                          pbrt::ReflectreeMode::Exact};

TEST(PbrtBxdf, IsSoundInEveryModeAndOnBothSides) {
  const OwnedSampler sampler = built("ggx:alpha_x=0.3,alpha_y=0.15");
  for (const auto mode : modes) {
    for (const int side : {1, -1}) {
      const Diagnosis diagnosis = doctor(patient_of({sampler.get(), mode, {}}, side), quick());
      for (const Finding& f : diagnosis.findings) {
        EXPECT_FALSE(f.fault) << "mode " << int(mode) << " side " << side << "\n" << to_text(f);
      }
      EXPECT_TRUE(diagnosis.healthy());
    }
  }
}

TEST(PbrtBxdf, AWrongDensityIsFound) {
  const OwnedSampler sampler = built("ggx:alpha=0.3");
  const pbrt::ReflectreeBxDF bxdf(sampler.get(), pbrt::ReflectreeMode::Monotone, {});
  EXPECT_FALSE(doctor(patient_of(bxdf, 1, 1.05f), quick()).healthy());
}

TEST(PbrtBxdf, KeepsTheRules) {
  using namespace pbrt;
  const OwnedSampler sampler = built("ggx:alpha=0.3");
  const ReflectreeBxDF bxdf(sampler.get(), ReflectreeMode::Monotone, {});
  const Vector3f up(0.6f, 0, 0.8f), over(0, 0.6f, 0.8f), under(0, 0.6f, -0.8f);
  EXPECT_EQ(bxdf.Flags(), BxDFFlags::GlossyReflection);
  EXPECT_FALSE(
      bxdf.Sample_f(up, 0.3f, {0.2f, 0.7f}, TransportMode::Radiance, BxDFReflTransFlags::Transmission));
  EXPECT_EQ(bxdf.PDF(up, over, TransportMode::Radiance, BxDFReflTransFlags::Transmission), 0);
  EXPECT_EQ(bxdf.PDF(up, under, TransportMode::Radiance, BxDFReflTransFlags::All), 0);
  EXPECT_EQ(bxdf.f(up, under, TransportMode::Radiance)[0], 0);
  EXPECT_EQ(bxdf.f(up, over, TransportMode::Radiance)[0], bxdf.f(over, up, TransportMode::Importance)[0]);
  // One channel is grey.
  reflectree_function* one_channel = nullptr;
  ASSERT_EQ(reflectree_function_callback("matt", 1, 0, matt, nullptr, nullptr, &one_channel), REFLECTREE_OK);
  const OwnedSampler matt_sampler = built(one_channel);
  const ReflectreeBxDF grey(matt_sampler.get(), ReflectreeMode::Exact, {});
  for (const int c : {0, 1, 2}) EXPECT_EQ(grey.f(up, over, TransportMode::Radiance)[c], 0.08f);
}

}  // namespace
