// SPDX-License-Identifier: Apache-2.0
// Threads share one sampler: they draw what one thread draws, and ThreadSanitizer has nothing to say.
#include <gtest/gtest.h>

#include "functions.hpp"

namespace reflectree {
namespace {

template <class S>
double work(const S& s, std::uint64_t seed) {
  Pcg32 u(seed);
  double sum = 0;
  std::vector<DirectionSample<typename decltype(s.exact)::Value>> out(16);
  for (int i = 0; i < 3000; ++i) {
    const Direction wo = wo_at(89.9 * to_unit_double(u()), 6 * to_unit_double(u()));
    SampleStatistics statistics;
    const auto e = s.exact.sample(wo, u, statistics);
    const auto o = s.one_shot.sample(wo, u);
    const auto m = s.one_shot.sample(wo, 0.3, 0.6);
    sum += double(e->pdf + o->wi.x + m->wi.y) + double(statistics.trials);
    sum += double(s.exact.pdf(wo, o->wi) + s.one_shot.pdf(wo, e->wi));
    sum += double(s.exact.sample_n(wo, u, std::span(out)) + s.one_shot.sample_n(wo, u, std::span(out)));
    if (const auto once = s.exact.sample_once(wo, u)) sum += double(once->wi.z);
    if (const auto back = s.one_shot.invert(wo, e->wi)) sum += back->x;
  }
  return sum;
}

TEST(Concurrency, ThreadsThatShareASamplerDrawAsOne) {
  for (const char* text : {"plastic:alpha=0.3", "0.5*lambert + 0.5*ggx:alpha=0.3"}) {
    const auto s = make_sampler(material(text), {}, uneven_threads(2));
    constexpr std::size_t threads = 4;
    double alone[threads], shared[threads];
    for (std::size_t t = 0; t < threads; ++t) alone[t] = work(s, t);
    std::vector<std::thread> pool;
    for (std::size_t t = 0; t < threads; ++t) pool.emplace_back([&, t] { shared[t] = work(s, t); });
    for (std::thread& t : pool) t.join();
    for (std::size_t t = 0; t < threads; ++t) EXPECT_EQ(alone[t], shared[t]) << text;
    EXPECT_NE(alone[0], alone[1]);
  }
}

// Handles are values: a copy outlives the sampler it came from.
TEST(Concurrency, CopiesShareTheirData) {
  std::optional<ExactSampler<AnyBrdf>> copy;
  const PackedSampler* packed = nullptr;
  {
    const auto s = make_sampler(material("lambert"));
    copy = s.exact;
    packed = &s.one_shot.packed();
  }
  EXPECT_EQ(&copy->packed(), packed);
  Pcg32 u(1);
  EXPECT_TRUE(copy->sample(wo_at(30), u));
}

}  // namespace
}  // namespace reflectree
