// SPDX-License-Identifier: Apache-2.0
// One-shot mode takes two uniforms and keeps their order, so that low-discrepancy points stay well spread
// over the directions: Owen-scrambled Sobol' points against independent ones, under a sky with a gradient.
#include <cmath>
#include <cstdio>
#include <reflectree/brdf/models/ggx.hpp>
#include <reflectree/math/low_discrepancy.hpp>
#include <reflectree/sampler/sampler.hpp>

using namespace reflectree;

int main() {
  constexpr int points = 1024;
  constexpr std::uint32_t runs = 64;
  const auto sampler = make_sampler(Ggx{0.3f});
  const auto light = [](Direction wi) { return 1 + wi.x * wi.z; };
  const Direction wo = direction_from_angles(0.9f, 0.5f);

  const auto radiance = [&](auto uniforms) {
    double sum = 0;
    for (std::uint32_t i = 0; i < points; ++i) {
      const Vec2<double> u = uniforms(i);
      if (const auto s = sampler.one_shot.sample(wo, u.x, u.y))
        sum += double(s->weight.r * light(s->wi)) / points;
    }
    return sum;
  };
  // The scatter of independent runs, as a share of their mean.
  const auto scatter = [&](auto run) {
    double sum = 0, sum2 = 0;
    for (std::uint32_t seed = 1; seed <= runs; ++seed) {
      const double r = run(seed);
      sum += r, sum2 += r * r;
    }
    const double mean = sum / runs;
    return std::sqrt(sum2 / runs - mean * mean) / mean;
  };
  const double random = scatter([&](std::uint32_t seed) {
    Pcg32 bits(seed);
    return radiance([&](std::uint32_t) {
      const double u1 = to_unit_double(bits());
      return Vec2<double>{u1, to_unit_double(bits())};
    });
  });
  const double sobol = scatter([&](std::uint32_t seed) {
    return radiance([&](std::uint32_t i) {
      return Vec2<double>{scrambled_sobol(i, 0, seed), scrambled_sobol(i, 1, seed)};
    });
  });
  std::printf("relative error: %.2e random, %.2e Sobol'\n", random, sobol);
  if (sobol < random)
    std::printf("the error of %d points is %.1f times smaller with Sobol'\n", points, random / sobol);
}
