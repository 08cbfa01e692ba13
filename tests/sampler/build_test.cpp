// SPDX-License-Identifier: Apache-2.0
// What the builder refuses, and what it owes to its host.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <set>

#include "../error_words.hpp"
#include "functions.hpp"
#include "reflectree/error.hpp"

namespace reflectree {
namespace {

std::string error_of(const AnyBrdf& f, const BuildOptions& options = {}) {
  return error_words([&] { build(f, options); }, "");
}
bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

// The value `bad` in a patch of directions wi, matt elsewhere.
AnyBrdf spoilt(float bad, float from_z) {
  return
      [bad, from_z](Direction, Direction wi) { return wi.z > from_z && wi.z < from_z + 0.05f ? bad : 0.3f; };
}

TEST(Refusal, NamesTheDirectionsOfBadValues) {
  for (const float bad : {-1.f, -1e-6f, std::nanf(""), float(INFINITY), -float(INFINITY)}) {
    const std::string text = error_of(spoilt(bad, 0.5f));
    EXPECT_TRUE(contains(text, "wo = (") && contains(text, "wi = (")) << bad << ": " << text;
    EXPECT_FALSE(contains(text, "\n"));
  }
  // One channel is enough.
  const std::string text = error_of([](Direction, Direction wi) { return Rgb{0.1f, 0.1f, wi.z - 0.5f}; });
  EXPECT_TRUE(contains(text, "wi = (")) << text;
  EXPECT_EQ(error_of(spoilt(0.f, 0.5f)), "");
}

TEST(Refusal, StochasticFunctions) {
  auto calls = std::make_shared<std::atomic<unsigned>>(0);
  const std::string text =
      error_of([calls](Direction, Direction) { return 0.3f + 1e-3f * float((*calls)++ % 7); });
  EXPECT_TRUE(contains(text, "two calls") && contains(text, "wi = (")) << text;
}

struct FalselyIsotropic {
  BrdfTraits traits() const {
    BrdfTraits t;
    t.isotropic_by_formula = true;
    return t;
  }
  float operator()(Direction wo, Direction) const { return 0.3f + 0.1f * wo.x; }
};
TEST(Refusal, WhatSaysThatItIsIsotropicAndIsNot) {
  EXPECT_TRUE(contains(error_of(FalselyIsotropic{}), "says that it is isotropic"));
}

struct ManyChannels {
  int n;
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.channels = n;
    return traits;
  }
  Spectrum operator()(Direction, Direction) const { return Spectrum(std::min(n, max_channels)); }
};
TEST(Refusal, ImpossibleNumbersOfChannels) {
  try {
    AnyBrdf(ManyChannels{0});
    FAIL();
  } catch (const Error& e) {
    EXPECT_TRUE(contains(e.what(), "0 channels")) << e.what();
  }
}

// --- the host ----------------------------------------------------------------------------------------

TEST(Host, TheResultDoesNotDependOnItsThreads) {
  for (const char* text : {"plastic:alpha=0.2", "oren_nayar:sigma=0.4"}) {
    const AnyBrdf f = material(text);
    const SamplerData one = build(f);
    EXPECT_EQ(build(f, {}, uneven_threads(1)), one) << text;
    EXPECT_EQ(build(f, {}, uneven_threads(2)), one) << text;
    EXPECT_EQ(build(f, {}, uneven_threads(3)), one) << text;
    BuildOptions other;
    other.seed = 2;
    EXPECT_NE(build(f, other), one) << text;
  }
}

// The error that a user sees does not depend on the threads either.
TEST(Host, TheErrorDoesNotDependOnItsThreads) {
  const AnyBrdf f = [](Direction wo, Direction wi) {
    return wi.z < 1e-3f && wo.z < 0.3f ? std::nanf("") : 0.3f;  // rare: met in the batches of the build
  };
  const auto message = [&](const Host& host) -> std::string {
    return error_words([&] { build(f, {}, host); }, "");
  };
  const std::string one = message({});
  EXPECT_NE(one, "");
  EXPECT_EQ(message(uneven_threads(3)), one);
}

struct Solitary {
  std::shared_ptr<std::mutex> mutex = std::make_shared<std::mutex>();
  std::shared_ptr<std::set<std::thread::id>> callers = std::make_shared<std::set<std::thread::id>>();
  bool concurrent = false;
  BrdfTraits traits() const {
    BrdfTraits traits;
    traits.concurrent = concurrent;
    return traits;
  }
  float operator()(Direction wo, Direction wi) const {
    const std::lock_guard<std::mutex> lock(*mutex);
    callers->insert(std::this_thread::get_id());
    return 0.3f + 0.1f * dot(wo, wi);
  }
};
TEST(Host, AFunctionForOneThreadIsCalledFromTheCallersAlone) {
  const Solitary f;
  build(f, {}, uneven_threads(3));
  EXPECT_EQ(*f.callers, std::set<std::thread::id>{std::this_thread::get_id()});
  const Solitary g{std::make_shared<std::mutex>(), std::make_shared<std::set<std::thread::id>>(), true};
  build(g, {}, uneven_threads(3));
  EXPECT_GT(g.callers->size(), 1u);
}

TEST(Host, CancelsWheneverAsked) {
  const AnyBrdf f = material("plastic:alpha=0.1");
  for (const int after : {0, 1, 5, 20, 40}) {
    Host host;
    int asked = 0;
    host.cancelled = [&] { return asked++ >= after; };
    EXPECT_THROW(build(f, {}, host), Cancelled) << after;
  }
}

TEST(Host, ProgressGrowsToOne) {
  Host host;
  std::vector<float> seen;
  host.progress = [&](float p) { seen.push_back(p); };
  build(material("plastic:alpha=0.2"), {}, host);
  ASSERT_GE(seen.size(), 3u);
  for (std::size_t i = 1; i < seen.size(); ++i) EXPECT_GE(seen[i], seen[i - 1]);
  EXPECT_GE(seen.front(), 0);
  EXPECT_EQ(seen.back(), 1);
}

// --- identity ----------------------------------------------------------------------------------------

TEST(Identity, AnotherBrdfIsRefused) {
  const AnyBrdf f = material("ggx:alpha=0.2");
  const SamplerData data = build(f);
  EXPECT_NO_THROW(check_identity(data, f));
  EXPECT_NO_THROW(make_sampler(f, data));
  for (const char* other :
       {"ggx:alpha=0.21", "ggx:alpha=0.2,f0=0.9", "lambert", "ggx:alpha=0.2,f0=1/1/0.9"}) {
    try {
      make_sampler(material(other), data);
      ADD_FAILURE() << other;
    } catch (const Error& e) {
      EXPECT_TRUE(contains(e.what(), "ggx:alpha=0.2")) << e.what();
    }
  }
  SamplerData damaged = data;
  damaged.probes.target[5] = std::nanf("");
  EXPECT_THROW(check_identity(damaged, f), Error);
}

// --- options -----------------------------------------------------------------------------------------

TEST(Options, FewerTrialsCostLeavesAndAreKept) {
  const AnyBrdf f = material("ggx:alpha=0.3");
  std::size_t leaves = 0;
  for (const float trials : {2.f, 1.25f, 1.1f}) {
    BuildOptions options;
    options.expected_trials = trials;
    const auto s = make_sampler(f, options);
    EXPECT_GT(s.exact.packed().exact.leaves.size(), leaves) << trials;
    leaves = s.exact.packed().exact.leaves.size();
    Pcg32 u(1);
    for (int i = 0; i < 300; ++i) {
      const Direction wo = wo_at(89.999 * to_unit_double(u()));
      EXPECT_LE(s.exact.expected_trials(wo), trials * 1.0001f) << theta_of(wo);
    }
    // What is promised is what happens.
    SampleStatistics statistics;
    for (int i = 0; i < 100'000; ++i) s.exact.sample(wo_at(33), u, statistics);
    EXPECT_NEAR(double(statistics.trials) / double(statistics.accepted),
                double(s.exact.expected_trials(wo_at(33))), 0.02 * double(trials));
  }
}

TEST(Options, TheDomainCanBeChosen) {
  const AnyBrdf f = [](Direction wo, Direction wi) { return 0.3f + 0.1f * dot(wo, wi); };
  for (const DomainKind kind :
       {DomainKind::projected_disk, DomainKind::equal_area, DomainKind::half_vector, DomainKind::back_vector,
        DomainKind::mirror_vector, DomainKind::normal_vector}) {
    for (const Symmetry symmetry : {Symmetry::mirror, Symmetry::none}) {
      BuildOptions options;
      options.domain = Domain{kind, symmetry, kind == DomainKind::stretched ? 1.2f : 0.f};
      options.expected_trials = 1.5f;
      const auto s = make_sampler(f, options);
      EXPECT_EQ(s.exact.packed().domain, *options.domain);
      const auto results = judge(s, target_function(f), wo_at(50, 1), 100'000);
      EXPECT_TRUE(all_passed(results)) << name_of(kind) << int(symmetry) << '\n' << to_text(results);
    }
  }
}

}  // namespace
}  // namespace reflectree
