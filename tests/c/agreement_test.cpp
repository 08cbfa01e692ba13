// SPDX-License-Identifier: Apache-2.0
// The C interface gives what the C++ samplers give, bit by bit, and holds back what is thrown.
#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "reflectree.h"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/simd/sample_batch.hpp"

namespace reflectree {
namespace {

// The lambda of examples/ten_lines.cpp.
float dust(Direction wo, Direction wi) { return 0.3f / (wo.z + wi.z); }

int dust_in_c(void*, size_t n, const float* wo, const float* wi, float* values) {
  for (size_t i = 0; i < n; ++i) values[i] = 0.3f / (wo[3 * i + 2] + wi[3 * i + 2]);
  return 0;
}

std::vector<Direction> viewers(std::size_t n) {
  std::vector<Direction> wo;
  Pcg32 u(4);
  while (wo.size() < n) {
    const float z = to_unit_float(u()), phi = 2 * pi * to_unit_float(u()), r = sqrt(1 - z * z);
    wo.push_back({r * cos(phi), r * sin(phi), z});
  }
  return wo;
}

template <class S, class Draw>
void expect_same(const S& sampler, const std::vector<Direction>& wo, std::size_t channels, const Draw& draw) {
  std::vector<DirectionSample<typename S::Value>> ours(wo.size());
  Pcg32 u(9, 2);
  for (std::size_t i = 0; i < wo.size(); i += 64) {
    const std::size_t n = std::min<std::size_t>(64, wo.size() - i);
    sample_batch(sampler, std::span(wo).subspan(i, n), u, std::span(ours).subspan(i, n));
  }
  reflectree_pcg32 random;
  reflectree_pcg32_seed(&random, 9, 2);
  std::vector<float> wi(3 * wo.size()), pdf(wo.size()), weight(channels * wo.size());
  ASSERT_EQ(draw(reinterpret_cast<const float*>(wo.data()), &random, wi.data(), pdf.data(), weight.data()),
            REFLECTREE_OK);
  for (std::size_t i = 0; i < wo.size(); ++i) {
    ASSERT_EQ(ours[i].wi, (Direction{wi[3 * i], wi[3 * i + 1], wi[3 * i + 2]})) << i;
    ASSERT_EQ(ours[i].pdf, pdf[i]);
    for (std::size_t c = 0; c < channels; ++c)
      ASSERT_EQ(channel_value(ours[i].weight, int(c)), weight[channels * i + c]);
  }
}

// Null where it fails.
reflectree_sampler* dust_sampler() {
  reflectree_function* f = nullptr;
  reflectree_sampler* s = nullptr;
  EXPECT_EQ(reflectree_function_callback("lambda", 1, REFLECTREE_CONCURRENT, dust_in_c, nullptr, nullptr, &f),
            REFLECTREE_OK);
  EXPECT_EQ(reflectree_build(f, nullptr, &s), REFLECTREE_OK) << reflectree_last_error();
  reflectree_function_free(f);
  return s;
}

TEST(CInterface, GivesTheBitsOfTheSamplers) {
  const auto ours = make_sampler(dust);
  reflectree_sampler* s = dust_sampler();
  const std::vector<Direction> wo = viewers(5000);
  expect_same(ours.exact, wo, 1, [&](auto w, auto random, auto wi, auto pdf, auto weight) {
    return reflectree_sample_exact(s, wo.size(), w, reflectree_pcg32_next, random, wi, pdf, weight);
  });
  expect_same(ours.one_shot, wo, 1, [&](auto w, auto random, auto wi, auto pdf, auto weight) {
    return reflectree_sample_one_shot(s, wo.size(), w, reflectree_pcg32_next, random, wi, pdf, weight);
  });
  // The caller's bits are asked for in the same order.
  expect_same(ours.one_shot, wo, 1, [&](auto w, auto random, auto wi, auto pdf, auto weight) {
    return reflectree_sample_one_shot(
        s, wo.size(), w, [](void* state) { return reflectree_pcg32_next(state); }, random, wi, pdf, weight);
  });
  std::vector<double> u(2 * wo.size());
  std::vector<float> wi(3 * wo.size()), pdf(wo.size());
  Pcg32 random(3);
  for (double& x : u) x = to_unit_double(random());
  ASSERT_EQ(reflectree_sample_uniforms(s, wo.size(), reinterpret_cast<const float*>(wo.data()), u.data(),
                                       wi.data(), pdf.data(), nullptr),
            REFLECTREE_OK);
  for (std::size_t i = 0; i < wo.size(); ++i) {
    const auto sample = ours.one_shot.sample(wo[i], u[2 * i], u[2 * i + 1]);
    ASSERT_EQ(sample ? sample->pdf : 0, pdf[i]);
    ASSERT_EQ(sample ? sample->wi : Direction{}, (Direction{wi[3 * i], wi[3 * i + 1], wi[3 * i + 2]}));
  }
  reflectree_sampler_free(s);
}

// One viewer per call: the bits of `sample`, and "no sample" as zeros.
TEST(CInterface, DrawsOneByOneAsTheSamplersDo) {
  const auto ours = make_sampler(dust);
  reflectree_sampler* s = dust_sampler();
  Pcg32 u(9, 2);
  reflectree_pcg32 random;
  reflectree_pcg32_seed(&random, 9, 2);
  float wi[3], pdf, weight;
  const auto expect = [&](const auto& sample, reflectree_status status) {
    ASSERT_EQ(status, REFLECTREE_OK);
    ASSERT_EQ(sample ? sample->wi : Direction{}, (Direction{wi[0], wi[1], wi[2]}));
    ASSERT_EQ(sample ? sample->pdf : 0, pdf);
    ASSERT_EQ(sample ? channel_value(sample->weight, 0) : 0, weight);
  };
  std::vector<Direction> wo = viewers(1000);
  wo.push_back({0, 0.6f, -0.8f});  // from below
  for (const Direction w : wo) {
    const float known[3] = {w.x, w.y, w.z};
    const auto exact = ours.exact.sample(w, u);
    expect(exact, reflectree_sample_exact(s, 1, known, reflectree_pcg32_next, &random, wi, &pdf, &weight));
    const auto alias = ours.one_shot.sample(w, u);
    expect(alias, reflectree_sample_one_shot(s, 1, known, reflectree_pcg32_next, &random, wi, &pdf, &weight));
    const double points[2] = {to_unit_double(u()), to_unit_double(u())};
    reflectree_pcg32_next(&random), reflectree_pcg32_next(&random);
    const auto descended = ours.one_shot.sample(w, points[0], points[1]);
    expect(descended, reflectree_sample_uniforms(s, 1, known, points, wi, &pdf, &weight));
  }
  reflectree_sampler_free(s);
}

int throwing(void* user, size_t, const float*, const float*, float*) {
  if (user) throw std::runtime_error("thrown by a callback");
  throw 5;
}

TEST(CInterface, HoldsBackWhatIsThrown) {
  int number = 1;
  for (void* user : {static_cast<void*>(&number), static_cast<void*>(nullptr)}) {
    for (const uint32_t flags : {0U, uint32_t(REFLECTREE_CONCURRENT)}) {
      reflectree_function* f;
      reflectree_sampler* s = nullptr;
      ASSERT_EQ(reflectree_function_callback("throws", 1, flags, throwing, user, nullptr, &f), REFLECTREE_OK);
      EXPECT_EQ(reflectree_build(f, nullptr, &s), REFLECTREE_ERROR_INTERNAL);
      EXPECT_NE(std::string(reflectree_last_error()).find(user ? "thrown by a callback" : "callback threw"),
                std::string::npos);
      EXPECT_EQ(s, nullptr);
      reflectree_function_free(f);
    }
  }
}

// A function that asks the library again while it is called.
struct Nested {
  reflectree_sampler* inner;
};
int nested(void* user, size_t n, const float* wo, const float* wi, float* values) {
  return reflectree_eval(static_cast<Nested*>(user)->inner, n, wo, wi, values);
}

TEST(CInterface, MayBeCalledFromACallback) {
  reflectree_function *f, *g;
  Nested user{};
  reflectree_sampler* s;
  ASSERT_EQ(reflectree_function_callback("lambda", 1, 0, dust_in_c, nullptr, nullptr, &f), REFLECTREE_OK);
  ASSERT_EQ(reflectree_build(f, nullptr, &user.inner), REFLECTREE_OK);
  ASSERT_EQ(reflectree_function_callback("nested", 1, 0, nested, &user, nullptr, &g), REFLECTREE_OK);
  ASSERT_EQ(reflectree_build(g, nullptr, &s), REFLECTREE_OK) << reflectree_last_error();
  const float wo[3] = {0.6f, 0, 0.8f}, wi[3] = {0, 0, 1};
  float a, b;
  ASSERT_EQ(reflectree_eval(s, 1, wo, wi, &a), REFLECTREE_OK);
  ASSERT_EQ(reflectree_eval(user.inner, 1, wo, wi, &b), REFLECTREE_OK);
  EXPECT_EQ(a, b);
  EXPECT_EQ(a, dust({0.6f, 0, 0.8f}, {0, 0, 1}));
  for (auto* function : {f, g}) reflectree_function_free(function);
  for (auto* sampler : {s, user.inner}) reflectree_sampler_free(sampler);
}

TEST(CInterface, SentencesAreCutAtWholeCharacters) {
  const std::string text = std::string(1000, 'x') + std::string(50, '\xc3') + ":a=1";
  std::string umlauts = "gxg";
  for (int i = 0; i < 600; ++i) umlauts += "\xc3\xa4";
  reflectree_function* f;
  EXPECT_EQ(reflectree_function_open(umlauts.c_str(), nullptr, &f), REFLECTREE_ERROR_REFUSED);
  const std::string sentence = reflectree_last_error();
  EXPECT_LE(sentence.size(), 1023U);
  EXPECT_NE(std::uint8_t(sentence.back()), 0xc3);
  EXPECT_EQ(reflectree_function_open(text.c_str(), nullptr, &f), REFLECTREE_ERROR_REFUSED);
}

}  // namespace
}  // namespace reflectree
