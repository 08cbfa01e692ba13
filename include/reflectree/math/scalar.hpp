// SPDX-License-Identifier: Apache-2.0
// The scalar vocabulary in which reflectance models are written: one formula serves float, double
// and, later, outward-rounded intervals. Models use select, min and max instead of branches.
#pragma once

#include <cmath>
#include <type_traits>

// The hot path of sampling is one function to the optimiser: a call would pass its structs through memory.
#if defined(__GNUC__) || defined(__clang__)
#define REFLECTREE_INLINE [[gnu::always_inline]] inline
#define REFLECTREE_INLINE_LAMBDA __attribute__((always_inline))
#else
#define REFLECTREE_INLINE inline
#define REFLECTREE_INLINE_LAMBDA
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
constexpr T lerp(T t, T a, T b) {
  return a + t * (b - a);
}

// Found by overload: `using std::sqrt; sqrt(x)` would also find an interval's own.
using std::abs;
using std::acos;
using std::asin;
using std::atan2;
using std::cos;
using std::exp;
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
