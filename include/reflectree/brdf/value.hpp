// SPDX-License-Identifier: Apache-2.0
// What a BRDF returns: float, Rgb, or Spectrum (N channels known at run time). Unit sr^-1. Any arithmetic
// result counts as float, std::array<T, 3> as Rgb, another std::array as Spectrum.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <type_traits>

namespace reflectree {

template <class T>
struct RgbT {
  T r{}, g{}, b{};
  friend constexpr bool operator==(const RgbT&, const RgbT&) = default;
  friend constexpr RgbT operator+(RgbT a, RgbT b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
  friend constexpr RgbT operator-(RgbT a, RgbT b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
  friend constexpr RgbT operator*(RgbT a, RgbT b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
  friend constexpr RgbT operator*(T s, RgbT a) { return {s * a.r, s * a.g, s * a.b}; }
};
using Rgb = RgbT<float>;

// Parameters are stored as float; a model takes them in its scalar T.
template <class T>
constexpr RgbT<T> as_rgb(Rgb c) {
  return {T(c.r), T(c.g), T(c.b)};
}

inline constexpr int max_channels = 256;

// N channels in place, N known at run time; nothing is allocated and only N floats are copied.
class Spectrum {
 public:
  Spectrum() = default;
  explicit Spectrum(int channels) : channels_(channels) { std::fill_n(values_.begin(), channels, 0.f); }
  Spectrum(const Spectrum& other) : channels_(other.channels_) {
    std::copy_n(other.values_.begin(), channels_, values_.begin());
  }
  Spectrum& operator=(const Spectrum& other) {
    channels_ = other.channels_;
    std::copy_n(other.values_.begin(), channels_, values_.begin());
    return *this;
  }
  int channels() const { return channels_; }
  float* data() { return values_.data(); }
  const float* data() const { return values_.data(); }
  float& operator[](int i) { return values_[std::size_t(i)]; }
  float operator[](int i) const { return values_[std::size_t(i)]; }
  friend bool operator==(const Spectrum& a, const Spectrum& b) {
    return std::equal(a.data(), a.data() + a.channels_, b.data(), b.data() + b.channels_);
  }

 private:
  int channels_ = 0;
  std::array<float, max_channels> values_;  // only the first channels_ are set
};

template <class V>
concept BrdfValue = std::same_as<V, float> || std::same_as<V, Rgb> || std::same_as<V, Spectrum>;

// What a user's function returned, as one of the three.
template <BrdfValue V>
const V& as_value(const V& v) {
  return v;
}
template <class A>
requires(std::is_arithmetic_v<A> && !std::same_as<A, float>) float as_value(A v) {
  return static_cast<float>(v);
}
template <class A, std::size_t n>
requires(std::is_arithmetic_v<A>&& n >= 1 &&
         n <= std::size_t(max_channels)) auto as_value(const std::array<A, n>& v) {
  if constexpr (n == 3) {
    return Rgb{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  } else {
    Spectrum s{int(n)};
    for (std::size_t c = 0; c < n; ++c) s[int(c)] = static_cast<float>(v[c]);
    return s;
  }
}
template <class R>
concept BrdfResult = requires(const R& r) {
  as_value(r);
};

inline int channels_of(float) { return 1; }
inline int channels_of(const Rgb&) { return 3; }
inline int channels_of(const Spectrum& v) { return v.channels(); }

inline float channel_value(float v, int) { return v; }
inline float channel_value(const Rgb& v, int i) { return i == 0 ? v.r : i == 1 ? v.g : v.b; }
inline float channel_value(const Spectrum& v, int i) { return v[i]; }

inline float scaled_value(float v, float s) { return v * s; }
inline Rgb scaled_value(const Rgb& v, float s) { return s * v; }
inline Spectrum scaled_value(Spectrum v, float s) {
  for (int i = 0; i < v.channels(); ++i) v[i] *= s;
  return v;
}

// A value with every channel zero and as many channels as `like`.
inline float zero_like(float) { return 0.f; }
inline Rgb zero_like(const Rgb&) { return {}; }
inline Spectrum zero_like(const Spectrum& v) { return Spectrum(v.channels()); }

// Grey and RGB values as Rgb; of a longer spectrum, the first three channels.
inline Rgb to_rgb(float v) { return {v, v, v}; }
inline Rgb to_rgb(const Rgb& v) { return v; }
inline Rgb to_rgb(const Spectrum& v) {
  return v.channels() < 3 ? to_rgb(v.channels() ? v[0] : 0.f) : Rgb{v[0], v[1], v[2]};
}

}  // namespace reflectree
