// SPDX-License-Identifier: Apache-2.0
// Grey functions, colours, spectra and batches are sampled alike, for every target.
#include <gtest/gtest.h>

#include "functions.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/verify/faults.hpp"

namespace reflectree {
namespace {

// GGX as a batch function, to be compared with the static and the erased one.
struct BatchGgx {
  Ggx model;
  Rgb operator()(Direction wo, Direction wi) const { return model(shading_geometry(wo, wi)); }
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<Rgb> out) const {
    for (std::size_t i = 0; i < wo.size(); ++i) out[i] = (*this)(wo[i], wi[i]);
  }
};

TEST(Values, StaticErasedAndBatchDrawTheSame) {
  const Ggx ggx{0.2f, {1, 0.8f, 0.3f}};
  const SamplerData data = build(ggx);
  const auto a = make_sampler(ggx, data);
  const auto b = make_sampler(AnyBrdf(ggx), data);
  const auto c = make_sampler(AnyBrdf(BatchGgx{ggx}), data);
  Pcg32 ua(7), ub(7), uc(7);
  for (int i = 0; i < 2000; ++i) {
    const Direction wo = wo_at(0.04 * i, 0.01 * i);
    const auto same = [&](const auto& x, const auto& y, float tolerance) {
      ASSERT_TRUE(x && y);
      EXPECT_NEAR(x->pdf / y->pdf, 1, tolerance);
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(channel_value(x->weight, k), channel_value(y->weight, k), tolerance);
      EXPECT_EQ(x->wi, y->wi);
    };
    same(a.exact.sample(wo, ua), b.exact.sample(wo, ub), 0);
    same(a.one_shot.sample(wo, ua), b.one_shot.sample(wo, ub), 0);
    // From directions alone the half vector is computed again: rounding may differ.
    c.exact.sample(wo, uc);
    const auto z = c.one_shot.sample(wo, uc);
    const auto y = b.one_shot.sample(wo, uc);
    ASSERT_TRUE(z && y);
    EXPECT_NEAR(c.exact.pdf(wo, z->wi) / b.exact.pdf(wo, z->wi), 1, 1e-3);
  }
}

struct FiveChannels {
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.name = "five channels";
    traits.channels = 5;
    return traits;
  }
  Spectrum operator()(Direction wo, Direction wi) const {
    Spectrum s(5);
    const float c = dot(wo, wi);
    for (int i = 0; i < 5; ++i) s[i] = 0.1f * float(i + 1) * (1.5f + (i % 2 ? c : -c));
    return s;
  }
};

TEST(Values, SpectraAndGreyFunctionsPassChiSquare) {
  const auto judged = [](auto f, double theta) {
    const auto s = make_sampler(f);
    const auto results = judge(s, target_function(AnyBrdf(f)), wo_at(theta, 3));
    EXPECT_TRUE(all_passed(results)) << to_text(results);
  };
  judged(FiveChannels{}, 40);
  judged([](Direction wo, Direction wi) { return 0.2f + 0.1f * dot(wo, wi); }, 70);
}

// A target that looks at one channel still gives support, and unbiased weights, to the others.
TEST(Values, EveryTargetKeepsTheSupportOfAllChannels) {
  // Red shines forwards, blue backwards, and neither where the other does.
  const auto f = [](Direction wo, Direction wi) {
    const float c = wo.x * wi.x + wo.y * wi.y;
    return Rgb{max(-c, 0.f), 0.01f, max(c, 0.f)};
  };
  const Direction wo = wo_at(60, 1);
  const auto channel_albedo = [&](int k) {
    return reference_albedo(
               target_function([f, k](Direction o, Direction i) { return channel_value(f(o, i), k); }), wo)
        .value;
  };
  for (const Target target : {Target{TargetKind::luminance, 0}, Target{TargetKind::maximum, 0},
                              Target{TargetKind::channel, 0}, Target{TargetKind::channel, 2}}) {
    BuildOptions options;
    options.target = target;
    const auto s = make_sampler(f, options);
    const TargetFunction t = target_function(f, target);
    const auto results = judge(s, t, wo);
    EXPECT_TRUE(all_passed(results)) << to_text(results);
    Pcg32 u(8);
    for (int k = 0; k < 3; ++k) {
      const double albedo = channel_albedo(k);
      EXPECT_LT(std::abs(z_score(albedo, 100'000,
                                 [&] { return double(channel_value(s.exact.sample(wo, u)->weight, k)); })),
                4.5)
          << int(target.kind) << ' ' << k;
      EXPECT_LT(std::abs(z_score(albedo, 100'000,
                                 [&] { return double(channel_value(s.one_shot.sample(wo, u)->weight, k)); })),
                4.5)
          << int(target.kind) << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace reflectree
