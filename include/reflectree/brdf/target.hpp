// SPDX-License-Identifier: Apache-2.0
// The scalar t(wo, wi) that is sampled, reduced from the channels of f. `norm`, the root of the sum
// of squares, minimises the summed variance of the channels' weights (Cauchy-Schwarz). The others mix
// in 1 % of it, so that no channel loses support.
#pragma once

#include "reflectree/brdf/value.hpp"
#include "reflectree/math/scalar.hpp"

namespace reflectree {

enum class TargetKind : std::uint8_t { norm, luminance, maximum, channel };

struct Target {
  TargetKind kind = TargetKind::norm;
  std::uint16_t index = 0;  // which channel, for TargetKind::channel
  // A power of two that brings values whose squares would leave the range of float near 1; the builder finds
  // it. Targets and their albedo are in these units; pdf and weight do not depend on it.
  float scale = 1;
  friend bool operator==(const Target&, const Target&) = default;

  float operator()(float f) const { return scale * f; }
  float operator()(const Rgb& f) const {
    return kind == TargetKind::norm ? norm(scale * f) : (*this)(&f.r, 3);
  }
  float operator()(const Spectrum& f) const { return (*this)(f.data(), f.channels()); }
  float operator()(const float* f, int channels) const {
    if (channels == 1) return scale * f[0];
    return kind == TargetKind::norm ? norm(f, channels) : mixed(f, channels);
  }

  template <class T>
  static T norm(const RgbT<T>& f) {
    return sqrt(f.r * f.r + f.g * f.g + f.b * f.b);
  }

 private:
  float norm(const float* f, int channels) const {
    float sum = 0;
    for (int c = 0; c < channels; ++c) sum += sqr(scale * f[c]);
    return sqrt(sum);
  }
  float mixed(const float* f, int channels) const {
    float t = 0;
    if (kind == TargetKind::luminance && channels == 3) {
      t = 0.2126f * f[0] + 0.7152f * f[1] + 0.0722f * f[2];  // ITU-R BT.709
    } else if (kind == TargetKind::luminance) {
      for (int c = 0; c < channels; ++c) t += f[c] / float(channels);
    } else if (kind == TargetKind::maximum) {
      for (int c = 0; c < channels; ++c) t = max(t, f[c]);
    } else {
      t = f[index < channels ? index : channels - 1];
    }
    return 0.99f * (scale * t) + 0.01f * norm(f, channels);
  }
};

}  // namespace reflectree
