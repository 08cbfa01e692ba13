// SPDX-License-Identifier: Apache-2.0
// A reflectance function of one's own, in colour: what was built for it, and what it is worth. Minnaert's
// law darkens or brightens towards the rim; a lobe about the mirror direction lies over it.
#include <cmath>
#include <cstdio>
#include <reflectree/sampler/sampler.hpp>

using namespace reflectree;

int main() {
  const auto f = [](Direction wo, Direction wi) {
    const float minnaert = std::pow(wo.z * wi.z, -0.2f) / pi;
    const float mirror = wo.z * wi.z - wo.x * wi.x - wo.y * wi.y;  // wi . (wo mirrored about the normal)
    const float lobe = mirror > 0 ? 3 * std::pow(mirror, 100.f) : 0.f;
    return Rgb{0.3f * minnaert + lobe, 0.2f * minnaert + lobe, 0.1f * minnaert + lobe};
  };
  const SamplerData data = build(f);
  std::printf("domain %s, %zu slabs, %.3f expected trials\n", name_of(data.domain.kind), data.exact.size(),
              double(data.report.expected_trials));

  // The green albedo at 40 degrees, three ways; the sampler's weights hardly vary.
  const auto sampler = make_sampler(f, data);
  const Direction wo = direction_from_angles(40 * pi / 180, 0.f);
  Pcg32 random(1);
  const auto standard_error = [](auto draw) {
    double sum = 0, sum2 = 0;
    constexpr int n = 200'000;
    for (int i = 0; i < n; ++i) {
      const double value = double(draw());
      sum += value, sum2 += value * value;
    }
    return std::sqrt(sum2 / n - sum / n * (sum / n)) / (sum / n);
  };
  const double exact = standard_error([&] { return sampler.exact.sample(wo, random)->weight.g; });
  const double one_shot = standard_error([&] { return sampler.one_shot.sample(wo, random)->weight.g; });
  const double uniform = standard_error([&] {
    const float z = to_unit_float(random()), phi = 2 * pi * to_unit_float(random());
    const float s = std::sqrt(1 - z * z);
    const Direction wi{s * std::cos(phi), s * std::sin(phi), z};
    return eval(f, wo, wi).g * z * 2 * pi;
  });
  std::printf("relative standard error per sample: %.3f exact, %.3f one-shot, %.3f uniform\n", exact,
              one_shot, uniform);
}
