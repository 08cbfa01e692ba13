// SPDX-License-Identifier: Apache-2.0
// A sampler before its judges: every way in, every density, what it is packed from; its type erased.
#pragma once

#include <memory>

#include "reflectree/verify/ways.hpp"

namespace reflectree {

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
  // One trial of exact mode with its unbiased weight, channel by channel; zeros for none.
  std::function<void(Direction wo, Pcg32& u, std::span<float> weights)> once;
  const PackedSampler* packed = nullptr;
  const SamplerData* data = nullptr;  // the canonical form, where it is at hand

  std::size_t channels() const { return std::size_t(f.channels()); }
  bool concurrent() const { return f.traits().concurrent; }
};

// Borrows sampler and data. f: the sampler's own function.
template <Brdf F>
Suspect suspect(const Sampler<F>& sampler, AnyBrdf f, const SamplerData* data = nullptr) {
  const std::size_t channels = std::size_t(f.channels());
  const PackedSampler& packed = sampler.exact.packed();
  Suspect s{std::move(f), packed.target, ways_into(sampler.exact, channels), {}, {}, {}, {}, {}, {}, {},
            &packed,      data};
  for (WayIn& way : ways_into(sampler.one_shot, channels)) s.ways.push_back(std::move(way));
  s.exact_pdf = [&sampler](Direction wo, Direction wi) { return sampler.exact.pdf(wo, wi); };
  s.one_shot_pdf = [&sampler](Direction wo, Direction wi) { return sampler.one_shot.pdf(wo, wi); };
  s.albedo = [&sampler](Direction wo) { return double(sampler.exact.albedo(wo)); };
  s.point = [&sampler](Direction wo, double u1, double u2) -> std::optional<Direction> {
    if (const auto drawn = sampler.one_shot.sample(wo, u1, u2)) return drawn->wi;
    return std::nullopt;
  };
  s.invert = [&sampler](Direction wo, Direction wi) { return sampler.one_shot.invert(wo, wi); };
  s.propose = [&sampler](Direction wo, Pcg32& u) -> std::optional<Direction> {
    if (const auto drawn = sampler.one_shot.propose(wo, u)) return drawn->wi;
    return std::nullopt;
  };
  s.once = [&sampler, channels](Direction wo, Pcg32& u, std::span<float> weights) {
    const auto drawn = sampler.exact.sample_once(wo, u);
    for (std::size_t c = 0; c < channels; ++c) weights[c] = drawn ? channel(drawn->weight, int(c)) : 0.f;
  };
  return s;
}

}  // namespace reflectree
