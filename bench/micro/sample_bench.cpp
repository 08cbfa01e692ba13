// SPDX-License-Identifier: Apache-2.0
// Nanoseconds per direction, each beside the floor: polar cosine-hemisphere sampling with the same generator in
// the same run. wo comes from a pool of 4096 cosine-distributed directions, a new one for every sample;
// evaluation and weight are included. Ratios are printed by tools/bench_ratios.py.
#include <benchmark/benchmark.h>

#include <vector>

#include "reflectree/brdf/material/model_family.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/math/low_discrepancy.hpp"
#include "reflectree/sampler/family_sampler.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/simd/sample_batch.hpp"

namespace {

using namespace reflectree;

Direction cosine_direction(Pcg32& u) {
  const float r = sqrt(to_unit_float(u())), phi = 2 * pi * to_unit_float(u());
  return {r * cos(phi), r * sin(phi), sqrt(max(1 - r * r, 0.f))};
}

const std::vector<Direction>& pool() {
  static const std::vector<Direction> directions = [] {
    std::vector<Direction> w;
    Pcg32 u(2008);
    while (w.size() < 4096) {
      const Direction d = cosine_direction(u);
      if (d.z > 1e-3f) w.push_back(d);
    }
    return w;
  }();
  return directions;
}

const Sampler<Ggx>& ggx(float alpha) {
  static std::vector<std::pair<float, Sampler<Ggx>>> made;
  for (const auto& [a, sampler] : made) {
    if (a == alpha) return sampler;
  }
  return made.emplace_back(alpha, make_sampler(Ggx{alpha})).second;
}

template <class Draw>
void run(benchmark::State& state, Draw&& draw) {
  const std::vector<Direction>& wo = pool();
  Pcg32 u(1);
  std::size_t i = 0;
  float sum = 0;
  for (auto _ : state) {
    sum += draw(wo[i++ & 4095U], u);
    benchmark::DoNotOptimize(sum);
  }
}

void cosine_hemisphere(benchmark::State& state) {
  run(state, [](Direction, Pcg32& u) {
    const Direction w = cosine_direction(u);
    return w.x + w.y + w.z;
  });
}
BENCHMARK(cosine_hemisphere);

template <class Value>
float gathered(const std::optional<DirectionSample<Value>>& s) {
  return s ? s->wi.x + s->wi.y + s->wi.z + s->pdf + s->weight.r + s->weight.g + s->weight.b : 0.f;
}

void exact(benchmark::State& state) {
  const auto& sampler = ggx(float(state.range(0)) * 1e-3f).exact;
  run(state, [&](Direction wo, Pcg32& u) { return gathered(sampler.sample(wo, u)); });
}
BENCHMARK(exact)->Arg(300)->Arg(100)->Arg(10);

void one_shot_alias(benchmark::State& state) {
  const auto& sampler = ggx(float(state.range(0)) * 1e-3f).one_shot;
  run(state, [&](Direction wo, Pcg32& u) { return gathered(sampler.sample(wo, u)); });
}
BENCHMARK(one_shot_alias)->Arg(300)->Arg(100)->Arg(10);

void one_shot_monotone(benchmark::State& state) {
  const auto& sampler = ggx(float(state.range(0)) * 1e-3f).one_shot;
  run(state, [&](Direction wo, Pcg32& u) {
    const double u1 = to_unit_double(u()), u2 = to_unit_double(u());
    return gathered(sampler.sample(wo, u1, u2));
  });
}
BENCHMARK(one_shot_monotone)->Arg(300)->Arg(100)->Arg(10);

const Sampler<Ggx>& brushed() {
  static const auto sampler = make_sampler(Ggx{Widths{0.05f, 0.3f}});
  return sampler;
}
void anisotropic_exact(benchmark::State& state) {
  const auto& sampler = brushed().exact;
  run(state, [&](Direction wo, Pcg32& u) { return gathered(sampler.sample(wo, u)); });
}
BENCHMARK(anisotropic_exact);
void anisotropic_one_shot_alias(benchmark::State& state) {
  const auto& sampler = brushed().one_shot;
  run(state, [&](Direction wo, Pcg32& u) { return gathered(sampler.sample(wo, u)); });
}
BENCHMARK(anisotropic_one_shot_alias);

// Every sample is one of another member of the family, as under a texture.
const FamilySampler<ModelFamily<Ggx>>& family() {
  static const auto sampler = make_sampler(model_family(Ggx{}, {{"alpha", 0.02f, 1}}));
  return sampler;
}
float any_alpha(Pcg32& u) { return 0.02f + 0.98f * to_unit_float(u()); }
void family_exact(benchmark::State& state) {
  const auto& sampler = family().exact;
  run(state, [&](Direction wo, Pcg32& u) { return gathered(sampler.sample(wo, {any_alpha(u)}, u)); });
}
BENCHMARK(family_exact);
void family_one_shot_alias(benchmark::State& state) {
  const auto& sampler = family().one_shot;
  run(state, [&](Direction wo, Pcg32& u) { return gathered(sampler.sample(wo, {any_alpha(u)}, u)); });
}
BENCHMARK(family_one_shot_alias);

// 256 directions per call; the time is that of the call, items_per_second counts directions.
constexpr std::size_t batch_size = 256;
template <class Draw>
void run_batches(benchmark::State& state, Draw&& draw) {
  const std::vector<Direction>& wo = pool();
  std::vector<DirectionSample<Rgb>> out(batch_size);
  Pcg32 u(1);
  std::size_t i = 0;
  for (auto _ : state) {
    draw(std::span(wo).subspan(i, batch_size), u, std::span(out));
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
    i = (i + batch_size) & 4095U;
  }
  state.SetItemsProcessed(std::int64_t(state.iterations() * batch_size));
}

void exact_batch(benchmark::State& state) {
  const auto& sampler = ggx(float(state.range(0)) * 1e-3f).exact;
  run_batches(state, [&](auto wo, Pcg32& u, auto out) { sample_batch(sampler, wo, u, out); });
}
BENCHMARK(exact_batch)->Arg(300)->Arg(100)->Arg(10);

void one_shot_alias_batch(benchmark::State& state) {
  const auto& sampler = ggx(float(state.range(0)) * 1e-3f).one_shot;
  run_batches(state, [&](auto wo, Pcg32& u, auto out) { sample_batch(sampler, wo, u, out); });
}
BENCHMARK(one_shot_alias_batch)->Arg(300)->Arg(100)->Arg(10);

void anisotropic_exact_batch(benchmark::State& state) {
  const auto& sampler = brushed().exact;
  run_batches(state, [&](auto wo, Pcg32& u, auto out) { sample_batch(sampler, wo, u, out); });
}
BENCHMARK(anisotropic_exact_batch);
void anisotropic_one_shot_alias_batch(benchmark::State& state) {
  const auto& sampler = brushed().one_shot;
  run_batches(state, [&](auto wo, Pcg32& u, auto out) { sample_batch(sampler, wo, u, out); });
}
BENCHMARK(anisotropic_one_shot_alias_batch);

void one_shot_monotone_batch(benchmark::State& state) {
  const auto& sampler = ggx(float(state.range(0)) * 1e-3f).one_shot;
  run_batches(state, [&](auto wo, Pcg32& u, auto out) {
    Vec2<double> points[batch_size];
    for (Vec2<double>& p : points) {
      p.x = to_unit_double(u());
      p.y = to_unit_double(u());
    }
    sample_batch(sampler, wo, std::span<const Vec2<double>>(points), out);
  });
}
BENCHMARK(one_shot_monotone_batch)->Arg(300)->Arg(100)->Arg(10);

void exact_pdf(benchmark::State& state) {
  const auto& sampler = ggx(0.1f).exact;
  run(state, [&](Direction wo, Pcg32&) { return sampler.pdf(wo, Direction{-wo.x, -wo.y, wo.z}); });
}
BENCHMARK(exact_pdf);

void one_shot_pdf(benchmark::State& state) {
  const auto& sampler = ggx(0.1f).one_shot;
  run(state, [&](Direction wo, Pcg32&) { return sampler.pdf(wo, Direction{-wo.x, -wo.y, wo.z}); });
}
BENCHMARK(one_shot_pdf);

void evaluation(benchmark::State& state) {
  const Ggx f{0.1f};
  run(state, [&](Direction wo, Pcg32&) { return eval(f, wo, Direction{-wo.x, -wo.y, wo.z}).r; });
}
BENCHMARK(evaluation);

}  // namespace

BENCHMARK_MAIN();
