// SPDX-License-Identifier: Apache-2.0
// A lambda, its sampler, and one integral by it: the albedo of 0.5 / pi is 0.5.
#include <cmath>
#include <cstdio>
#include <reflectree/sampler/sampler.hpp>

using namespace reflectree;

int main() {
  const auto f = [](Direction, Direction) { return 0.5f / pi; };  // sr^-1, without cosine
  const auto sampler = make_sampler(f);
  Pcg32 random(1);
  double exact = 0, one_shot = 0;
  const int n = 1000;
  for (int i = 0; i < n; ++i) {
    const Direction wo = direction_from_angles(1.5f * to_unit_float(random()), 0.f);
    if (const auto s = sampler.exact.sample(wo, random)) exact += double(s->weight) / n;
    if (const auto s = sampler.one_shot.sample(wo, random)) one_shot += double(s->weight) / n;
  }
  std::printf("albedo: exact %.4f, one-shot %.4f\n", exact, one_shot);
  return std::abs(exact - 0.5) < 0.005 && std::abs(one_shot - 0.5) < 0.01 ? 0 : 1;
}
