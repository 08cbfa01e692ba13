// SPDX-License-Identifier: Apache-2.0
// The shortest way in: a function, its sampler, an integral. Light comes from within 60 degrees of the
// normal; in closed form the result is 0.484.
#include <cstdio>
#include <reflectree/sampler/sampler.hpp>

using namespace reflectree;

int main() {
  const auto f = [](Direction wo, Direction wi) { return 0.3f / (wo.z + wi.z); };  // sr^-1, without cosine
  const auto light = [](Direction wi) { return wi.z > 0.5f ? 1.f : 0.f; };
  const auto sampler = make_sampler(f);
  const Direction wo = direction_from_angles(0.8f, 0.f);  // towards the viewer; z is the normal
  Pcg32 random(1);
  float radiance = 0;
  for (int i = 0; i < 100000; ++i) {
    if (const auto s = sampler.exact.sample(wo, random)) radiance += s->weight * light(s->wi) / 100000;
  }
  std::printf("reflected radiance %.3f\n", double(radiance));
}
