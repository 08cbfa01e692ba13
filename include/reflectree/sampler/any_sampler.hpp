// SPDX-License-Identifier: Apache-2.0
// AnySampler: a sampler of directions chosen at run time, ours or a peer's. A value (shared, immutable inside).
#pragma once

#include <memory>
#include <span>
#include <string>

#include "reflectree/math/uniform_bits.hpp"
#include "reflectree/sampler/direction_sample.hpp"

namespace reflectree {

// A sampler that divides N directions itself: sample_n(wo, u, out) returns how many were filled.
template <class S>
concept ManyDirectionsSampler = DirectionSampler<S> &&
    requires(const S& s, Direction w, UniformBits& u, std::span<DirectionSample<typename S::Value>> out) {
  { s.sample_n(w, u, out) } -> std::same_as<std::size_t>;
};

// A sampler that draws without the function.
template <class S>
concept ProposingSampler = DirectionSampler<S> && requires(const S& s, Direction w, UniformBits& u) {
  { s.propose(w, u) } -> std::same_as<std::optional<Proposal>>;
};

template <BrdfValue V>
class AnySampler {
 public:
  using Value = V;

  // `bytes`: what the sampler holds in memory besides the function.
  template <DirectionSampler S>
  requires std::same_as<typename S::Value, V> AnySampler(std::string name, S sampler, std::size_t bytes = 0)
      : self_(std::make_shared<const Model<S>>(std::move(name), bytes, std::move(sampler))) {}

  const std::string& name() const { return self_->name; }
  std::size_t bytes() const { return self_->bytes; }

  std::optional<DirectionSample<V>> sample(Direction wo, UniformBits& u) const {
    return self_->sample(wo, u);
  }
  std::optional<DirectionSample<V>> sample(Direction wo, Pcg32& u) const {
    UniformBits bits(u);
    auto drawn = self_->sample(wo, bits);
    u = bits.rest();
    return drawn;
  }
  // The estimator of a sum over N directions is the mean over out.size(), not over those filled.
  std::size_t sample_n(Direction wo, UniformBits& u, std::span<DirectionSample<V>> out) const {
    return self_->sample_n(wo, u, out);
  }
  // Whether it divides N directions itself, rather than drawing one after the other.
  bool divides() const { return self_->divides; }
  // What `sample` draws, without the function; for samplers that need it to draw, never called.
  bool proposes() const { return self_->proposes; }
  std::optional<Proposal> propose(Direction wo, UniformBits& u) const { return self_->propose(wo, u); }
  bool has_pdf() const { return self_->has_pdf; }
  // Per solid angle, sr^-1; 0 for a method without a density.
  float pdf(Direction wo, Direction wi) const { return self_->pdf(wo, wi); }

 private:
  struct Interface {
    std::string name;
    std::size_t bytes = 0;
    bool has_pdf = false, divides = false, proposes = false;
    virtual ~Interface() = default;
    virtual std::optional<DirectionSample<V>> sample(Direction, UniformBits&) const = 0;
    virtual std::size_t sample_n(Direction, UniformBits&, std::span<DirectionSample<V>>) const = 0;
    virtual std::optional<Proposal> propose(Direction, UniformBits&) const = 0;
    virtual float pdf(Direction, Direction) const = 0;
  };
  template <class S>
  struct Model final : Interface {
    S sampler;
    Model(std::string the_name, std::size_t the_bytes, S s) : sampler(std::move(s)) {
      this->name = std::move(the_name), this->bytes = the_bytes, this->has_pdf = DensitySampler<S>;
      this->divides = ManyDirectionsSampler<S>, this->proposes = ProposingSampler<S>;
    }
    std::optional<DirectionSample<V>> sample(Direction wo, UniformBits& u) const override {
      return sampler.sample(wo, u);
    }
    std::size_t sample_n(Direction wo, UniformBits& u, std::span<DirectionSample<V>> out) const override {
      if constexpr (ManyDirectionsSampler<S>) {
        return sampler.sample_n(wo, u, out);
      } else {
        std::size_t filled = 0;
        for (std::size_t i = 0; i < out.size(); ++i) {
          if (auto drawn = sampler.sample(wo, u)) out[filled++] = *drawn;
        }
        return filled;
      }
    }
    std::optional<Proposal> propose(Direction wo, UniformBits& u) const override {
      if constexpr (ProposingSampler<S>) return sampler.propose(wo, u);
      return std::nullopt;
    }
    float pdf(Direction wo, Direction wi) const override {
      if constexpr (DensitySampler<S>) return sampler.pdf(wo, wi);
      return 0;
    }
  };

  std::shared_ptr<const Interface> self_;
};

}  // namespace reflectree
