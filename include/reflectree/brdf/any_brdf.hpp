// SPDX-License-Identifier: Apache-2.0
// AnyBrdf: a BRDF chosen at run time. A value (shared, immutable inside); erased once per batch.
#pragma once

#include <memory>
#include <vector>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/brdf/own_bound.hpp"
#include "reflectree/error.hpp"

namespace reflectree {

// A function that writes the channels of whole batches itself, zero below the surface: a sum, a table of
// many channels. AnyBrdf passes the spans on.
template <class F>
concept ChannelBatchBrdf = Brdf<F> &&
    requires(const F& f, std::span<const Direction> w, std::span<const ShadingGeometry<float>> g,
             std::span<float> out) {
  f.eval(w, w, out);
  f.eval(g, out);
};

namespace detail {
[[noreturn]] inline void throw_channels(int returned, const BrdfTraits& traits) {
  throw Error("the BRDF returned " + std::to_string(returned) + " channels where it has " +
                  std::to_string(traits.channels),
              traits.name, "return the same number for all directions; if it has traits(), say it there");
}
}  // namespace detail

class AnyBrdf {
 public:
  template <class F>
  requires(!std::same_as<std::remove_cvref_t<F>, AnyBrdf>) && Brdf<std::remove_cvref_t<F>> AnyBrdf(F f)
      : self_(std::make_shared<const Model<std::remove_cvref_t<F>>>(std::move(f))) {}
  // The same with a wrong result: one readable line instead of a page of constraints.
  template <class F>
  requires(!Brdf<F>) && std::is_invocable_v<const F&, Direction, Direction> AnyBrdf(const F&) {
    static_assert(std::is_void_v<F>, "a BRDF returns a number, Rgb, Spectrum or std::array");
  }

  const BrdfTraits& traits() const { return self_->traits; }
  int channels() const { return self_->traits.channels; }

  Spectrum operator()(const ShadingGeometry<float>& g) const {
    Spectrum value(channels());
    self_->eval({&g, 1}, {value.data(), std::size_t(channels())});
    return value;
  }
  // out[i * channels() + c]: channel c of f(wo[i], wi[i]), without cosine; zero below the surface.
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<float> out) const {
    self_->eval(wo, wi, out);
  }
  // The same for geometries whose cosines are positive.
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const {
    self_->eval(geometry, out);
  }

 private:
  struct Interface {
    BrdfTraits traits;
    virtual ~Interface() = default;
    virtual void eval(std::span<const Direction>, std::span<const Direction>, std::span<float>) const = 0;
    virtual void eval(std::span<const ShadingGeometry<float>>, std::span<float>) const = 0;
  };

  template <class F>
  struct Model final : Interface {
    F f;
    explicit Model(F function) : f(std::move(function)) {
      this->traits = traits_of(f);
      if (!this->traits.enclosure) this->traits.enclosure = detail::own_enclosure(f);
      if (this->traits.channels < 1 || this->traits.channels > max_channels) {
        throw Error("the BRDF has " + std::to_string(this->traits.channels) + " channels", this->traits.name,
                    "give it 1 to " + std::to_string(max_channels));
      }
    }

    void store(const ValueOf<F>& value, float* out) const {
      if constexpr (std::is_same_v<ValueOf<F>, Spectrum>) {
        if (value.channels() != this->traits.channels) detail::throw_channels(value.channels(), this->traits);
      }
      for (int c = 0; c < this->traits.channels; ++c) out[c] = channel_value(value, c);
    }
    void eval(std::span<const Direction> wo, std::span<const Direction> wi,
              std::span<float> out) const override {
      const auto stride = std::size_t(this->traits.channels);
      if constexpr (ChannelBatchBrdf<F>) {
        f.eval(wo, wi, out);
      } else if constexpr (BatchBrdf<F>) {
        std::vector<ValueOf<F>> values(wo.size());
        f.eval(wo, wi, values);
        for (std::size_t i = 0; i < wo.size(); ++i) {
          const bool above = wo[i].z > 0 && wi[i].z > 0;
          store(above ? values[i] : zero_like(values[i]), out.data() + i * stride);
        }
      } else {
        for (std::size_t i = 0; i < wo.size(); ++i) {
          store(reflectree::eval(f, wo[i], wi[i]), out.data() + i * stride);
        }
      }
    }
    void eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const override {
      const auto stride = std::size_t(this->traits.channels);
      if constexpr (ChannelBatchBrdf<F>) {
        f.eval(geometry, out);
      } else if constexpr (BatchBrdf<F>) {
        std::vector<Direction> wo(geometry.size()), wi(geometry.size());
        for (std::size_t i = 0; i < geometry.size(); ++i) wo[i] = geometry[i].wo, wi[i] = geometry[i].wi;
        eval(wo, wi, out);
      } else {
        for (std::size_t i = 0; i < geometry.size(); ++i) {
          store(reflectree::eval(f, geometry[i]), out.data() + i * stride);
        }
      }
    }
  };

  std::shared_ptr<const Interface> self_;
};

}  // namespace reflectree
