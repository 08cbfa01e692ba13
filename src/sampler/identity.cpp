// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/identity.hpp"

#include <cmath>
#include <cstdio>

#include "reflectree/error.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {

namespace {

// Half of the pairs scatter over the hemisphere, half lie near the mirror direction.
void probe_pair(std::size_t i, Direction& wo, Direction& wi) {
  Pcg32 u(i, 77);
  const auto unit = [&u] { return to_unit_float(u()); };
  wo = direction_from_angles(1.5f * unit(), 6.2831853f * unit());
  wi = direction_from_angles(1.5f * unit(), 6.2831853f * unit());
  if (i % 2) {
    const float tilt = 0.15f * unit(), turn = 6.2831853f * unit();
    wi = reflect(wo, direction_from_angles(tilt, turn));
  }
}

}  // namespace

BrdfProbes probe_identity(const AnyBrdf& f, const Target& target) {
  std::vector<Direction> wo(BrdfProbes::count), wi(BrdfProbes::count);
  for (std::size_t i = 0; i < BrdfProbes::count; ++i) probe_pair(i, wo[i], wi[i]);
  std::vector<float> values(BrdfProbes::count * std::size_t(f.channels()));
  f.eval(wo, wi, values);
  BrdfProbes probes;
  for (std::size_t i = 0; i < BrdfProbes::count; ++i) {
    probes.target[i] = target(values.data() + i * std::size_t(f.channels()), f.channels());
  }
  return probes;
}

void check_identity(const SamplerData& data, const AnyBrdf& f, float relative_tolerance) {
  const BrdfProbes now = probe_identity(f, data.target);
  std::size_t worst = 0;
  float worst_miss = 0;
  for (std::size_t i = 0; i < BrdfProbes::count; ++i) {
    const float a = data.probes.target[i], b = now.target[i];
    float miss = abs(a - b) / (1e-6f + max(abs(a), abs(b)));
    if (!isfinite(miss)) miss = 2;  // more than any two numbers can differ
    if (miss > worst_miss) worst_miss = miss, worst = i;
  }
  if (worst_miss <= relative_tolerance) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "the sampler was built for another BRDF: at probe %zu its target was %.6g, here it is %.6g",
                worst, double(data.probes.target[worst]), double(now.target[worst]));
  throw Error(text, f.traits().name, "load it with the material '" + data.material + "', or build it again");
}

}  // namespace reflectree
