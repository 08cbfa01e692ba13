// SPDX-License-Identifier: Apache-2.0
// Most peers are a density over directions: a way to draw one and its value, with the function only in the
// weight. A density is plain immutable data with three functions; WeightedSampler adds the weight,
// once for all.
#pragma once

#include <optional>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/math/uniform_bits.hpp"
#include "reflectree/sampler/direction_sample.hpp"

namespace reflectree {

struct DrawnFromDensity {
  Direction wi;
  float pdf = 0;  // per solid angle, sr^-1
};

// sample: nullopt where the method loses the sample (below the horizon); pdf: what sample returns, 0 outside
// of the support; bytes: everything held in memory.
template <class D>
concept DirectionDensity = requires(const D& d, Direction w, UniformBits& u) {
  { d.sample(w, u) } -> std::same_as<std::optional<DrawnFromDensity>>;
  { d.pdf(w, w) } -> std::same_as<float>;
  { d.bytes() } -> std::same_as<std::size_t>;
};

template <Brdf F, DirectionDensity D>
class WeightedSampler {
 public:
  using Value = ValueOf<F>;

  WeightedSampler(F f, D density) : f_(std::move(f)), density_(std::move(density)) {}

  const D& density() const { return density_; }

  template <RandomBits U>
  std::optional<DirectionSample<Value>> sample(Direction wo, U& u) const {
    if (!(wo.z > 0)) return std::nullopt;
    const auto drawn = draw(wo, u);
    if (!drawn || !(drawn->wi.z > 0) || !(drawn->pdf > 0)) return std::nullopt;
    return DirectionSample<Value>{drawn->wi, drawn->pdf,
                                  scaled_value(eval(f_, wo, drawn->wi), drawn->wi.z / drawn->pdf)};
  }
  float pdf(Direction wo, Direction wi) const { return wo.z > 0 && wi.z > 0 ? density_.pdf(wo, wi) : 0.f; }

 private:
  std::optional<DrawnFromDensity> draw(Direction wo, UniformBits& u) const { return density_.sample(wo, u); }
  std::optional<DrawnFromDensity> draw(Direction wo, Pcg32& u) const {
    UniformBits bits(u);
    auto drawn = density_.sample(wo, bits);
    u = bits.rest();
    return drawn;
  }

  F f_;
  D density_;
};

}  // namespace reflectree
