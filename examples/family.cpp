// SPDX-License-Identifier: Apache-2.0
// One sampler of every roughness: a metal whose width a texture varies, under a small bright light.
#include <cmath>
#include <cstdio>
#include <reflectree/brdf/material/model_family.hpp>
#include <reflectree/brdf/models/ggx.hpp>
#include <reflectree/sampler/family_sampler.hpp>

using namespace reflectree;

int main() {
  BuildOptions quick;
  quick.expected_trials = 1.5f, quick.one_shot_variance = 0.05f, quick.albedo_error = 1e-3f;
  const auto sampler = make_sampler(model_family(Ggx{}, {{"alpha", 0.1f, 1}}), quick);
  const auto texture = [](float u) { return 0.55f + 0.45f * std::sin(40 * u); };
  const auto light = [](Direction wi) { return wi.z > 0.9f ? 1.f : 0.f; };
  const Direction wo = direction_from_angles(0.6f, 1.f);
  constexpr int pixels = 100'000;
  Pcg32 random(1);
  double radiance = 0;
  int dark = 0;
  for (int i = 0; i < pixels; ++i) {
    const float alpha = clamp(texture(float(i) / pixels), 0.1f, 1.f);
    const auto s = sampler.exact.sample(wo, {alpha}, random);
    if (s)
      radiance += double(s->weight.g * light(s->wi)) / pixels;
    else
      ++dark;
  }
  std::printf("reflected radiance %.3f, %d pixels without a sample\n", radiance, dark);
}
