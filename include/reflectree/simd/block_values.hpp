// SPDX-License-Identifier: Apache-2.0
// What f returns for a block of trials: in lanes where its formula is a template on the scalar; by one erased
// call per block for AnyBrdf; else one by one.
#pragma once

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/target.hpp"
#include "reflectree/simd/trial_block.hpp"

namespace reflectree {

// A BRDF whose one formula instantiates for Lanes.
template <class F>
concept LaneBrdf = GeometryBrdf<F> && requires(const F& f, const ShadingGeometry<Lanes>& g) {
  { f(g) } -> std::same_as<RgbT<Lanes>>;
};

namespace detail {

inline ShadingGeometry<float> lane_of(const ShadingGeometry<Lanes>& g, std::size_t i) {
  const auto vector = [i](const Vec3<Lanes>& w) { return Direction{w.x[i], w.y[i], w.z[i]}; };
  return {vector(g.wo),     vector(g.wi),     vector(g.wh),    g.cos_theta_o[i],
          g.cos_theta_i[i], g.cos_theta_h[i], g.cos_theta_d[i]};
}

// f one by one. `evaluate` takes the lanes from k on; `finish` the number of trials; then value and target.
template <Brdf F>
class BlockValues {
 public:
  using Value = ValueOf<F>;
  BlockValues(const F& f, const Target& target) : f_(f), target_(target) {}

  void evaluate(std::size_t k, const ShadingGeometry<Lanes>& g) {
    for (std::size_t i = 0; i < lane_count; ++i) geometry_[k + i] = lane_of(g, i);
  }
  void finish(std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      values_[k] = eval(f_, geometry_[k]);
      targets_[k] = target_(values_[k]);
    }
  }
  const Value& value(std::size_t k) const { return values_[k]; }
  Lanes target(std::size_t k) const { return Lanes::load(targets_ + k); }
  Value zero() const {
    const Direction normal{0, 0, 1};
    return zero_like(eval(f_, shading_geometry(normal, normal)));
  }

 private:
  const F& f_;
  const Target& target_;
  ShadingGeometry<float> geometry_[block_size];
  Value values_[block_size];
  float targets_[block_size] = {};
};

template <LaneBrdf F>
class BlockValues<F> {
 public:
  using Value = Rgb;
  BlockValues(const F& f, const Target& target) : f_(f), target_(target) {}

  REFLECTREE_INLINE void evaluate(std::size_t k, const ShadingGeometry<Lanes>& g) {
    const RgbT<Lanes> v = f_(g);
    v.r.store(channel_[0] + k);
    v.g.store(channel_[1] + k);
    v.b.store(channel_[2] + k);
  }
  void finish(std::size_t) {}
  Rgb value(std::size_t k) const { return {channel_[0][k], channel_[1][k], channel_[2][k]}; }
  REFLECTREE_INLINE Lanes target(std::size_t k) const {
    if (target_.kind == TargetKind::norm) {
      const Lanes scale(target_.scale);
      return Target::norm(scale * RgbT<Lanes>{Lanes::load(channel_[0] + k), Lanes::load(channel_[1] + k),
                                              Lanes::load(channel_[2] + k)});
    }
    float t[lane_count];
    for (std::size_t i = 0; i < lane_count; ++i) t[i] = target_(value(k + i));
    return Lanes::load(t);
  }
  Rgb zero() const { return {}; }

 private:
  const F& f_;
  const Target& target_;
  float channel_[3][block_size];
};

template <>
class BlockValues<AnyBrdf> {
 public:
  using Value = Spectrum;
  BlockValues(const AnyBrdf& f, const Target& target)
      : f_(f), target_(target), channels_(std::size_t(f.channels())), values_(block_size * channels_) {}

  void evaluate(std::size_t k, const ShadingGeometry<Lanes>& g) {
    for (std::size_t i = 0; i < lane_count; ++i) geometry_[k + i] = lane_of(g, i);
  }
  void finish(std::size_t count) {
    f_.eval({geometry_, count}, {values_.data(), count * channels_});
    for (std::size_t k = 0; k < count; ++k) targets_[k] = target_(&values_[k * channels_], int(channels_));
  }
  Spectrum value(std::size_t k) const {
    Spectrum v{int(channels_)};
    std::copy_n(&values_[k * channels_], channels_, v.data());
    return v;
  }
  Lanes target(std::size_t k) const { return Lanes::load(targets_ + k); }
  Spectrum zero() const { return Spectrum(int(channels_)); }

 private:
  const AnyBrdf& f_;
  const Target& target_;
  std::size_t channels_;
  ShadingGeometry<float> geometry_[block_size];
  std::vector<float> values_;
  float targets_[block_size] = {};
};

}  // namespace detail
}  // namespace reflectree
