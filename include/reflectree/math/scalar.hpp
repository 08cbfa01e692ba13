// SPDX-License-Identifier: Apache-2.0
// The scalar vocabulary in which reflectance models are written: one formula serves float, double,
// vector lanes and affine forms. Models use select, min and max instead of branches.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

// The hot path of sampling is one function to the optimiser: a call would pass its structs through memory.
// Builds with sanitizers define REFLECTREE_PLAIN_INLINE: what they add to each operation would make of that one
// function more than a compiler digests in minutes.
#if (defined(__GNUC__) || defined(__clang__)) && !defined(REFLECTREE_PLAIN_INLINE)
#define REFLECTREE_INLINE [[gnu::always_inline]] inline
#define REFLECTREE_INLINE_LAMBDA __attribute__((always_inline))
#define REFLECTREE_NOINLINE [[gnu::noinline]]
#else
#define REFLECTREE_INLINE inline
#define REFLECTREE_INLINE_LAMBDA
#define REFLECTREE_NOINLINE
#endif

namespace reflectree {

template <class T>
requires std::is_floating_point_v<T>
constexpr T select(bool condition, T if_true, T if_false) { return condition ? if_true : if_false; }
template <class T>
requires std::is_floating_point_v<T>
constexpr T min(T a, T b) { return b < a ? b : a; }
template <class T>
requires std::is_floating_point_v<T>
constexpr T max(T a, T b) { return a < b ? b : a; }
template <class T>
constexpr T clamp(T x, T lo, T hi) {
  return min(max(x, lo), hi);
}
template <class T>
constexpr T sqr(T x) {
  return x * x;
}
template <class T>
constexpr T linear_mix(T t, T a, T b) {
  return a + t * (b - a);
}

// if_positive or if_negative by the sign bit of s; in integers, since a branch would be a coin toss.
REFLECTREE_INLINE float by_sign(float s, float if_positive, float if_negative) {
  const auto a = std::bit_cast<std::uint32_t>(if_positive), b = std::bit_cast<std::uint32_t>(if_negative);
  const std::uint32_t negative = std::uint32_t(0) - (std::bit_cast<std::uint32_t>(s) >> 31U);
  return std::bit_cast<float>(a ^ ((a ^ b) & negative));
}
// x, its sign turned around where the sign bit of s is set.
REFLECTREE_INLINE float flip_sign(float x, float s) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) ^
                              (std::bit_cast<std::uint32_t>(s) & 0x80000000U));
}

// Scalars for which a short polynomial is as good as libm.
template <class T>
inline constexpr bool single_precision = std::is_same_v<T, float>;

// Found by overload: `using std::sqrt; sqrt(x)` would also find an interval's own.
using std::abs;
using std::acos;
using std::asin;
using std::atan2;
using std::cos;
using std::exp;
using std::expm1;
using std::isfinite;
using std::log;
using std::log1p;
using std::pow;
using std::sin;
using std::sqrt;
using std::tan;

template <class T>
inline constexpr T pi_v = T(3.14159265358979323846L);
inline constexpr float pi = pi_v<float>;

}  // namespace reflectree
