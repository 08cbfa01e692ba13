// SPDX-License-Identifier: Apache-2.0
// A sampler before its judges: every way in, every density, what it is packed from; its type erased. Made by
// suspect() in ways.hpp.
#pragma once

#include <optional>
#include <vector>

#include "reflectree/brdf/family.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/verify/way_in.hpp"

namespace reflectree {

struct PackedSampler;
struct SamplerData;

struct Suspect {
  AnyBrdf f;
  Target target;
  std::vector<WayIn> ways;
  std::function<float(Direction wo, Direction wi)> exact_pdf, one_shot_pdf;
  std::function<double(Direction wo)> albedo;  // exact mode's, of the target
  // One-shot mode by two uniforms, back again, and without f.
  std::function<std::optional<Direction>(Direction wo, double u1, double u2)> point;
  std::function<std::optional<Vec2<double>>(Direction wo, Direction wi)> invert;
  std::function<std::optional<Direction>(Direction wo, Pcg32& u)> propose;
  // One trial of exact mode with its unbiased weight, channel by channel; zeros for none. Empty: there is no
  // such way in.
  std::function<void(Direction wo, Pcg32& u, std::span<float> weights)> once;
  // Of a family: f is its member there.
  std::optional<AnyFamily> family = {};
  Parameters at = {};
  const PackedSampler* packed = nullptr;
  const SamplerData* data = nullptr;  // the canonical form, where it is at hand

  std::size_t channels() const { return std::size_t(f.channels()); }
  bool concurrent() const { return f.traits().concurrent; }
};

}  // namespace reflectree
