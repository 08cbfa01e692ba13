// SPDX-License-Identifier: Apache-2.0
// What somebody may bring as a function, and what the builder says of it: channels, frames, scale, options.
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "functions.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/known/albedo.hpp"
#include "reflectree/simd/sample_batch.hpp"

namespace reflectree {
namespace {

// The sentence with which a build is refused; empty where it is not.
template <class F>
std::string refusal(const F& f, const BuildOptions& options = {}, const Host& host = {}) {
  try {
    build(AnyBrdf(f), options, host);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// Mean weight per channel of exact mode over cubature, worst channel.
template <class F>
double worst_channel(const F& f, const Sampler<F>& s, Direction wo, int channels) {
  Pcg32 u(3);
  std::vector<double> sum(std::size_t(channels), 0);
  constexpr int n = 40'000;
  for (int i = 0; i < n; ++i) {
    if (const auto drawn = s.exact.sample(wo, u)) {
      for (int c = 0; c < channels; ++c) sum[std::size_t(c)] += double(channel_value(drawn->weight, c)) / n;
    }
  }
  double worst = 0;
  for (int c = 0; c < channels; ++c) {
    const auto g = [&f, c](Direction o, Direction i) { return channel_value(eval(f, o, i), c); };
    const double expected = reference_albedo(target_function(AnyBrdf(g)), wo).value;
    worst = std::max(worst, std::abs(sum[std::size_t(c)] / expected - 1));
  }
  return worst;
}

template <int n>
Spectrum coloured(Direction wo, Direction wi) {
  Spectrum s(n);
  for (int c = 0; c < n; ++c) s[c] = 0.1f + 0.2f * float(c) * wo.z * wi.z;
  return s;
}

TEST(Channels, ASpectrumWithoutTraitsIsAsked) {
  const auto two = coloured<2>;
  EXPECT_EQ(AnyBrdf(two).channels(), 2);
  const auto four = [](Direction o, Direction i) { return coloured<4>(o, i); };
  EXPECT_EQ(AnyBrdf(four).channels(), 4);
  EXPECT_LT(worst_channel(four, make_sampler(four), wo_at(40, 1), 4), 0.02);
}

TEST(Channels, OneThatChangesIsRefused) {
  const auto f = [](Direction, Direction i) { return Spectrum(i.z < 0.2f ? 2 : 3); };
  EXPECT_TRUE(has(refusal(f), "returned 2 channels where it has 3")) << refusal(f);
  EXPECT_THROW(AnyBrdf([](Direction, Direction) { return Spectrum(0); }), Error);
}

TEST(Channels, NumbersAndArraysAreValues) {
  const auto whole = [](Direction, Direction) { return 1; };
  const auto wide = [](Direction o, Direction i) { return 0.3 / double(o.z + i.z); };
  const auto yes = [](Direction, Direction i) { return i.z > 0.5f; };
  const auto rgb = [](Direction, Direction) { return std::array<double, 3>{0.1, 0.2, 0.3}; };
  const auto five = [](Direction, Direction i) { return std::array<float, 5>{0.1f, 0.2f, 0.3f, i.z, 0.5f}; };
  static_assert(
      std::is_same_v<ValueOf<decltype(whole)>, float> && std::is_same_v<ValueOf<decltype(wide)>, float> &&
      std::is_same_v<ValueOf<decltype(yes)>, float> && std::is_same_v<ValueOf<decltype(rgb)>, Rgb> &&
      std::is_same_v<ValueOf<decltype(five)>, Spectrum>);
  EXPECT_EQ(AnyBrdf(five).channels(), 5);
  EXPECT_NEAR(make_sampler(whole).exact.albedo(wo_at(30)), pi, 1e-3);
  EXPECT_LT(worst_channel(five, make_sampler(five), wo_at(40), 5), 0.02);
  const auto written = channel_brdf(7, [](Direction, Direction, std::span<float> out) {
    for (std::size_t c = 0; c < out.size(); ++c) out[c] = 0.01f * float(c + 1);
  });
  EXPECT_EQ(AnyBrdf(written).channels(), 7);
  EXPECT_EQ(eval(written, wo_at(0), wo_at(10))[6], 0.07f);
}

// Within rounding isotropic, and yet its values differ with the azimuth: they are the caller's.
struct AlmostIsotropic {
  float operator()(Direction wo, Direction wi) const {
    return 0.3f * (1 + 1e-4f * std::cos(std::atan2(wo.y, wo.x))) * (1 + 0.2f * dot(wo, wi));
  }
};

TEST(Frames, ValuesAreThoseOfTheCallersDirections) {
  const AlmostIsotropic f;
  const auto s = make_sampler(f);
  Pcg32 u(1);
  constexpr std::size_t n = 256;
  std::vector<Direction> wo(n);
  for (Direction& w : wo) w = wo_at(80 * to_unit_double(u()), 6.28 * to_unit_double(u()));
  std::vector<DirectionSample<float>> batch(n), points(n);
  std::vector<Vec2<double>> uniforms(n);
  for (auto& p : uniforms) p = {to_unit_double(u()), to_unit_double(u())};
  sample_batch(s.exact, wo, u, batch);
  sample_batch(s.one_shot, wo, std::span<const Vec2<double>>(uniforms), points);
  for (std::size_t i = 0; i < n; ++i) {
    const auto one = s.exact.sample(wo[i], u), shot = s.one_shot.sample(wo[i], uniforms[i].x, uniforms[i].y);
    ASSERT_TRUE(one && shot);
    for (const auto& d : {*one, *shot, batch[i], points[i]}) {
      const float f_cos = f(wo[i], d.wi) * d.wi.z;
      EXPECT_NEAR(d.weight * d.pdf / f_cos, 1, 2e-6) << i;
    }
    EXPECT_NEAR(s.exact.pdf(wo[i], one->wi) / one->pdf, 1, 2e-6);
  }
}

// A GGX that does not say that it is isotropic: evaluated in the caller's frame, in lanes too.
struct SilentGgx {
  template <class T>
  RgbT<T> operator()(const ShadingGeometry<T>& g) const {
    return Ggx{0.1f}(g);
  }
};
TEST(Frames, LanesAreTurnedBackAsOneByOne) {
  const SilentGgx f;
  const auto s = make_sampler(f);
  EXPECT_FALSE(s.exact.evaluates_turned());
  EXPECT_TRUE(make_sampler(Ggx{0.1f}).exact.evaluates_turned());
  std::vector<Direction> wo(100);
  Pcg32 u(1);
  for (Direction& w : wo) w = wo_at(85 * to_unit_double(u()), 6.28 * to_unit_double(u()));
  std::vector<DirectionSample<Rgb>> out(wo.size());
  Pcg32 a(7), b(7);
  sample_batch(s.one_shot, wo, a, out);
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const auto one = s.one_shot.sample(wo[i], b);
    ASSERT_TRUE(one);
    EXPECT_EQ(one->weight, out[i].weight) << i;
    EXPECT_EQ(one->wi, out[i].wi) << i;
  }
}

// A lobe of azimuths and a faint wave, which the mean over pairs hardly shows, are seen and kept.
TEST(Frames, WhatDependsOnTheAzimuthIsFound) {
  const auto bright = [](Direction, Direction i) {
    const float away = std::remainder(std::atan2(i.y, i.x) - 1, 6.2831853f);
    return 0.2f * (1 + 0.3f * std::exp(-sqr(away / 0.2f)));
  };
  const auto wave = [](Direction, Direction i) {
    return 0.2f * (1 + 0.015f * std::cos(2 * std::atan2(i.y, i.x)));
  };
  BuildOptions options;
  options.expected_trials = 1.5f, options.one_shot_variance = 0.05f, options.albedo_error = 1e-3f;
  EXPECT_FALSE(build(AnyBrdf(bright), options).frame.isotropic());
  EXPECT_EQ(build(AnyBrdf(wave), options).frame.symmetry, ViewerSymmetry::two_planes);
  EXPECT_EQ(refusal(AlmostIsotropic{}), "");
  // Steps that rounding may cross are no anisotropy.
  const auto steps = [](Direction o, Direction i) { return int(20 * dot(o, i)) % 2 ? 0.3f : 0.2f; };
  EXPECT_TRUE(build(AnyBrdf(steps)).frame.isotropic());
}

TEST(Scale, SquaresMayLeaveTheRangeOfFloat) {
  const auto lobe = [](float scale) {
    return [scale](Direction o, Direction i) {
      const Direction d{i.x + o.x, i.y + o.y, i.z - o.z};
      const float g = std::exp(-dot(d, d) / 0.04f);
      return Rgb{scale * (0.1f + g), scale * (0.1f + 0.5f * g), scale * 0.1f};
    };
  };
  const auto plain = lobe(1);
  const double expected = double(make_sampler(plain).exact.albedo(wo_at(40)));
  for (const float scale : {1e-24f, 1e22f}) {
    const auto f = lobe(scale);
    const SamplerData data = build(AnyBrdf(f));
    EXPECT_NE(data.target.scale, 1) << scale;
    const auto s = make_sampler(f, data);
    EXPECT_NEAR(double(s.exact.albedo(wo_at(40))) / double(data.target.scale) / double(scale) / expected, 1,
                1e-3);
    Pcg32 u(1);
    std::vector<Direction> wo(2000, wo_at(40, 2));
    std::vector<DirectionSample<Rgb>> batch(wo.size());
    sample_batch(s.exact, wo, u, batch);
    double sum = 0;
    for (const auto& d : batch)
      sum += double(Target{}(Rgb{d.weight.r / scale, d.weight.g / scale, d.weight.b / scale})) /
             double(wo.size());
    EXPECT_NEAR(sum / expected, 1, 1e-3) << scale;
  }
  EXPECT_TRUE(has(refusal(lobe(2e38f)), "leave the range of float")) << refusal(lobe(2e38f));
  EXPECT_TRUE(has(refusal(lobe(1e-42f)), "few digits")) << refusal(lobe(1e-42f));
}

TEST(Refusals, SayWhatWasReturnedAndWhere) {
  const auto below = [](Direction, Direction i) { return i.z < 0.4f ? -1e-9f : 0.2f; };
  EXPECT_TRUE(has(refusal(below), "[-1e-09], which is negative")) << refusal(below);
  EXPECT_TRUE(has(refusal(below), "clamp the value at 0"));
  EXPECT_TRUE(has(refusal(below), "wo = (") && has(refusal(below), "wi = ("));
  const auto nan = [](Direction, Direction i) {
    return i.z < 0.02f ? std::numeric_limits<float>::quiet_NaN() : 0.2f;
  };
  EXPECT_TRUE(has(refusal(nan), "[nan]: it must be finite")) << refusal(nan);
}

TEST(Options, OutOfRangeAreRefusedByName) {
  const auto f = [](Direction, Direction) { return 0.3f; };
  const auto with = [&](auto&& change) {
    BuildOptions options;
    change(options);
    return refusal(f, options);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {1.f, 0.f, -2.f, 16.1f, 64.f, 1e9f, nan}) {
    EXPECT_TRUE(has(with([&](BuildOptions& o) { o.expected_trials = bad; }), "expected_trials is")) << bad;
  }
  for (const float bad : {0.f, -1.f, nan}) {
    EXPECT_TRUE(has(with([&](BuildOptions& o) { o.albedo_error = bad; }), "albedo_error is")) << bad;
    EXPECT_TRUE(has(with([&](BuildOptions& o) { o.one_shot_variance = bad; }), "one_shot_variance is"))
        << bad;
  }
  EXPECT_TRUE(has(with([](BuildOptions& o) { o.target = {TargetKind::channel, 1}; }), "channel 1 of 1"));
  EXPECT_TRUE(has(with([](BuildOptions& o) {
                    o.domain = Domain{DomainKind::stretched, Symmetry::mirror, 2};
                  }),
                  "exponent"));
  EXPECT_TRUE(has(with([](BuildOptions& o) { o.max_evaluations = 0; }), "max_evaluations is 0"));
}

TEST(Options, AHostMayLeaveThingsOut) {
  Host host;
  host.progress = nullptr, host.stage = nullptr, host.cancelled = nullptr, host.parallel_for = nullptr;
  EXPECT_EQ(refusal([](Direction, Direction) { return 0.3f; }, {}, host), "");
}

TEST(Options, ABuildThatMayNotEvaluateMuchEndsAndSaysSo) {
  BuildOptions options;
  options.max_evaluations = 1'500'000;
  const SamplerData data = build(material("ggx:alpha=0.002"), options);
  ASSERT_FALSE(data.report.notes.empty());
  EXPECT_TRUE(has(data.report.notes[0], "budget") || has(data.report.notes[0], "albedo"))
      << data.report.notes[0];
  EXPECT_LT(data.report.evaluations, 30'000'000U);
  EXPECT_TRUE(build(material("ggx:alpha=0.2")).report.notes.empty());
}

TEST(Sample, OddInputIsNoSample) {
  const auto s = make_sampler([](Direction, Direction) { return 0.3f; });
  const Direction wo = wo_at(30);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [a, b] : {std::pair{-0.1, 0.3}, {0.3, 1.1}, {nan, 0.5}, {0.5, nan}}) {
    EXPECT_FALSE(s.one_shot.sample(wo, a, b)) << a << ' ' << b;
    std::vector<DirectionSample<float>> out(1);
    const Vec2<double> point{a, b};
    sample_batch(s.one_shot, {&wo, 1}, std::span<const Vec2<double>>(&point, 1), out);
    EXPECT_EQ(out[0].flags, 0u);
  }
  for (const float length : {0.9f, 1.1f}) {
    Pcg32 u(1);
    EXPECT_FALSE(s.exact.sample(length * wo, u)) << length;
    EXPECT_FALSE(s.one_shot.sample(length * wo, 0.3, 0.3)) << length;
    EXPECT_EQ(s.exact.pdf(length * wo, wo), 0) << length;
  }
  EXPECT_TRUE(s.one_shot.sample(wo, 0.0, 1.0));
}

TEST(Identity, PermutedChannelsAreAnotherFunction) {
  const auto f = [](Direction, Direction i) { return Rgb{0.1f, 0.2f, 0.3f * i.z}; };
  const auto permuted = [](Direction, Direction i) { return Rgb{0.3f * i.z, 0.2f, 0.1f}; };
  const SamplerData data = build(AnyBrdf(f));
  EXPECT_NO_THROW(make_sampler(f, data));
  try {
    make_sampler(permuted, data);
    FAIL();
  } catch (const Error& e) {
    EXPECT_TRUE(has(e.what(), "its channel")) << e.what();
  }
  EXPECT_TRUE(build(material("ggx")).probes.channels.empty());  // its name says which channels are meant
}

}  // namespace
}  // namespace reflectree
