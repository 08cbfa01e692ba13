// SPDX-License-Identifier: Apache-2.0
// What a BRDF returns: float, Rgb, or Spectrum (N channels known at run time). Unit sr^-1.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>

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

// Parameters are stored as float; a model lifts them to its scalar T.
template <class T>
constexpr RgbT<T> lift(Rgb c) {
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

inline int channels_of(float) { return 1; }
inline int channels_of(const Rgb&) { return 3; }
inline int channels_of(const Spectrum& v) { return v.channels(); }

inline float channel(float v, int) { return v; }
inline float channel(const Rgb& v, int i) { return i == 0 ? v.r : i == 1 ? v.g : v.b; }
inline float channel(const Spectrum& v, int i) { return v[i]; }

inline float scaled(float v, float s) { return v * s; }
inline Rgb scaled(const Rgb& v, float s) { return s * v; }
inline Spectrum scaled(Spectrum v, float s) {
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
