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

std::vector<float> probe_channels(const AnyBrdf& f) {
  std::vector<Direction> wo(BrdfProbes::count), wi(BrdfProbes::count);
  for (std::size_t i = 0; i < BrdfProbes::count; ++i) probe_pair(i, wo[i], wi[i]);
  std::vector<float> values(BrdfProbes::count * std::size_t(f.channels()));
  f.eval(wo, wi, values);
  return values;
}

// Each pair asks another member: the first ones at the ends of the ranges, the others anywhere.
std::vector<float> probe_channels(const AnyFamily& family) {
  std::vector<float> values;
  for (std::size_t i = 0; i < BrdfProbes::count; ++i) {
    Direction wo, wi;
    probe_pair(i, wo, wi);
    Pcg32 u(i, 78);
    Parameters at{};
    for (std::size_t k = 0; k < family.ranges().size(); ++k) {
      const ParameterRange& range = family.ranges()[k];
      const float share = i < 4 ? float(i >> k & 1U) : to_unit_float(u());
      const KnownParameter p{range, is_logarithmic(range)};
      at[k] = value_of(p, linear_mix(share, lowest(p), highest(p)));
    }
    Spectrum value(family.channels());  // zero below the surface
    if (wo.z > 0 && wi.z > 0) value = family(shading_geometry(wo, wi), at);
    values.insert(values.end(), value.data(), value.data() + value.channels());
  }
  return values;
}

// Of functions without a name every channel is kept.
BrdfProbes probes_of(std::vector<float> values, int channels, bool is_named, const Target& target) {
  BrdfProbes probes;
  for (std::size_t i = 0; i < BrdfProbes::count; ++i)
    probes.target[i] = target(values.data() + i * std::size_t(channels), channels);
  if (channels > 1 && !is_named) probes.channels = std::move(values);
  return probes;
}

}  // namespace

BrdfProbes probe_identity(const AnyBrdf& f, const Target& target) {
  return probes_of(probe_channels(f), f.channels(), f.traits().name != BrdfTraits{}.name, target);
}

BrdfProbes probe_identity(const AnyFamily& family, const Target& target) {
  const bool is_named = family.traits().name != Family<AnyFamily>{family, {}}.name;
  return probes_of(probe_channels(family), family.channels(), is_named, target);
}

namespace {

// Relative; more than any two numbers can differ where one is not finite.
float miss_of(float a, float b, float floor) {
  const float miss = abs(a - b) / (floor + max(abs(a), abs(b)));
  return isfinite(miss) ? miss : 2;
}

[[noreturn]] void refuse(const std::string& what, const SamplerData& data, const std::string& name) {
  throw Error("the sampler was built for another BRDF: " + what, name,
              "load it with the material '" + data.material + "', or build it again");
}

// F: AnyBrdf or AnyFamily.
template <class F>
void compare(const SamplerData& data, const F& f, float relative_tolerance) {
  const std::string& name = f.traits().name;
  const BrdfProbes now = probe_identity(f, data.target);
  std::size_t worst = 0;
  float worst_miss = 0;
  for (std::size_t i = 0; i < BrdfProbes::count; ++i) {
    const float miss = miss_of(data.probes.target[i], now.target[i], 1e-6f);
    if (miss > worst_miss) worst_miss = miss, worst = i;
  }
  char text[160];
  if (worst_miss > relative_tolerance) {
    std::snprintf(text, sizeof text, "at probe %zu its target was %.6g, here it is %.6g", worst,
                  double(data.probes.target[worst]), double(now.target[worst]));
    refuse(text, data, name);
  }
  const std::vector<float>& channels = data.probes.channels;
  if (channels.empty()) return;
  const std::size_t count = channels.size() / BrdfProbes::count;
  if (count != std::size_t(f.channels())) {
    refuse("it has " + std::to_string(count) + " channels, here there are " + std::to_string(f.channels()),
           data, name);
  }
  const std::vector<float> here = probe_channels(f);
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const std::size_t i = k / count, c = k % count;
    // Beside the pair's brightest channel: rounding of a dark one is no other function.
    const float floor =
        1e-3f * max(abs(data.probes.target[i]) / data.target.scale, 1e-6f / data.target.scale);
    if (miss_of(channels[k], here[k], floor) <= relative_tolerance) continue;
    std::snprintf(text, sizeof text, "at probe %zu its channel %zu was %.6g, here it is %.6g", i, c,
                  double(channels[k]), double(here[k]));
    refuse(text, data, name);
  }
}

}  // namespace

void check_identity(const SamplerData& data, const AnyBrdf& f, float relative_tolerance) {
  if (!data.parameters.empty()) {
    throw Error("the sampler is of a family, and this is one function", f.traits().name,
                "give it the family '" + data.material + "'");
  }
  compare(data, f, relative_tolerance);
}

void check_identity(const SamplerData& data, const AnyFamily& family, float relative_tolerance) {
  const std::vector<ParameterRange>& ranges = family.ranges();
  bool same = data.parameters.size() == ranges.size();
  for (std::size_t i = 0; same && i < ranges.size(); ++i) same = data.parameters[i].range == ranges[i];
  if (!same) {
    throw Error("the sampler was built for other ranges", family.traits().name,
                "load it with the material '" + data.material + "', or build it again");
  }
  compare(data, family, relative_tolerance);
}

}  // namespace reflectree
