// SPDX-License-Identifier: Apache-2.0
// What every sampler of directions returns, ours and the peers', and the concept they share.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>

#include "reflectree/brdf/shading_geometry.hpp"
#include "reflectree/brdf/value.hpp"
#include "reflectree/math/direction.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {

enum SampleFlags : std::uint32_t {
  sample_reflection = 1,  // wi on the side of wo
  sample_delta = 2,       // a discrete lobe: pdf is a probability, not a density
};

template <BrdfValue V>
struct DirectionSample {
  Direction wi;   // towards the light
  float pdf = 0;  // per solid angle, sr^-1
  V weight{};     // f_cos / pdf, per channel
  std::uint32_t flags = sample_reflection;
};

// A direction drawn without the function: its weight is scale * f(geometry).
struct Proposal {
  Direction wi;
  float pdf;  // per solid angle
  ShadingGeometry<float> geometry;
  float scale;
};

// sample: nullopt is "no sample" (wo below the horizon or not finite, albedo 0, trials exhausted).
// pdf per solid angle; a method without a density leaves pdf() out.
template <class S>
concept DirectionSampler = requires(const S& s, Direction w, Pcg32& u) {
  typename S::Value;
  { s.sample(w, u) } -> std::same_as<std::optional<DirectionSample<typename S::Value>>>;
};
template <class S>
concept DensitySampler = DirectionSampler<S> && requires(const S& s, Direction w) {
  { s.pdf(w, w) } -> std::convertible_to<float>;
};

}  // namespace reflectree
