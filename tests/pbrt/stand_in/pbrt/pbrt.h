// SPDX-License-Identifier: Apache-2.0
// What reflectree_bxdf.h asks of pbrt-v4, written for this test: names and meanings are pbrt's, nothing else is.
// The header is judged here wherever pbrt is not at hand, and inside pbrt where it is (judge.py).
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>

namespace pbrt {

using Float = float;
namespace pstd {
using std::optional;
}

struct Vector3f {
  Float x = 0, y = 0, z = 0;
  Vector3f() = default;
  Vector3f(Float x, Float y, Float z) : x(x), y(y), z(z) {}
};
inline bool SameHemisphere(Vector3f a, Vector3f b) { return a.z * b.z > 0; }

struct Point2f {
  Float x = 0, y = 0;
  Float operator[](int i) const { return i == 0 ? x : y; }
};

struct RGB {
  Float r, g, b;
  RGB(Float r, Float g, Float b) : r(r), g(g), b(b) {}
};
struct RGBColorSpace {
  static const RGBColorSpace* sRGB;
};
inline const RGBColorSpace srgb{};
inline const RGBColorSpace* RGBColorSpace::sRGB = &srgb;
struct SampledWavelengths {};
struct SampledSpectrum {
  Float values[3];
  explicit SampledSpectrum(Float v) : values{v, v, v} {}
  SampledSpectrum(Float r, Float g, Float b) : values{r, g, b} {}
  Float operator[](int i) const { return values[i]; }
};
struct RGBUnboundedSpectrum {
  RGB rgb;
  RGBUnboundedSpectrum(const RGBColorSpace&, RGB rgb) : rgb(rgb) {}
  SampledSpectrum Sample(const SampledWavelengths&) const { return {rgb.r, rgb.g, rgb.b}; }
};

enum class BxDFReflTransFlags { Unset = 0, Reflection = 1, Transmission = 2, All = 3 };
inline int operator&(BxDFReflTransFlags a, BxDFReflTransFlags b) { return int(a) & int(b); }
enum BxDFFlags { Unset = 0, Reflection = 1, Glossy = 8, GlossyReflection = 9 };
enum class TransportMode { Radiance, Importance };
struct BSDFSample {
  SampledSpectrum f;
  Vector3f wi;
  Float pdf;
  BxDFFlags flags;
  BSDFSample(SampledSpectrum f, Vector3f wi, Float pdf, BxDFFlags flags)
      : f(f), wi(wi), pdf(pdf), flags(flags) {}
};

struct Options {
  int seed = 0;
};
inline Options& GetOptions() {
  static Options options;
  return options;
}

// 64 bits of what is given (FNV-1a).
template <class... Parts>
std::uint64_t Hash(const Parts&... parts) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto add = [&](const auto& part) {
    unsigned char bytes[sizeof part];
    std::memcpy(bytes, &part, sizeof part);
    for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3U;
  };
  (add(parts), ...);
  return hash ^ (hash >> 31U);
}

// PCG32.
class RNG {
 public:
  RNG(std::uint64_t sequence, std::uint64_t offset) : increment_((sequence << 1U) | 1U) {
    next();
    state_ += offset;
    next();
  }
  template <class T>
  T Uniform() {
    return next();
  }

 private:
  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005U + increment_;
    const auto shifted = std::uint32_t(((old >> 18U) ^ old) >> 27U), turn = std::uint32_t(old >> 59U);
    return (shifted >> turn) | (shifted << ((32U - turn) & 31U));
  }
  std::uint64_t state_ = 0, increment_;
};

template <class... Parts>
std::string StringPrintf(const char* format, Parts... parts) {
  char text[200];
  std::snprintf(text, sizeof text, format, parts...);
  return text;
}
template <class... Parts>
[[noreturn]] void ErrorExit(const char* format, Parts... parts) {
  std::fprintf(stderr, format, parts...);
  std::exit(1);
}

}  // namespace pbrt
