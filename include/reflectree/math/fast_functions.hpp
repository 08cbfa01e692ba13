// SPDX-License-Identifier: Apache-2.0
// Trigonometry and exponentials of floats by short polynomials: no library call and no branch.
//
//   function              computes                        range                error in float
//   cos_sin_quarter(t)    {cos, sin} of pi t / 4          |t| <= 1             < 1.2e-7 absolute
//   cos_sin_half(t)       {cos, sin} of pi t / 2          |t| <= 1             < 2e-7 absolute
//   on_circle(t)          {cos, sin} of 2 pi t            0 <= t <= 1          < 1.2e-7 absolute
//   quarter_atan(t)       (4 / pi) atan(t)                |t| <= 1             < 3e-7 relative
//   first_quadrant_angle  atan2(y, x)                     x, y >= 0            < 3e-7 relative
//   angle_of(y, x)        atan2(y, x)                     all                  < 3e-7 relative
//   polar_angle(s2, c)    atan2(sqrt(s2), c)              s2 >= 0, c >= 0      < 3e-7 relative
//   exp_of_negative(x)    e^x                             x <= 0               < 1.5e-7 relative
//   log_of_positive(x)    log(x)                          x > 0                < 2.5e-7 relative
//
// tests/math/fast_functions_test.cpp measures every row. Other scalars take the library's functions.
#pragma once

#include <bit>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "reflectree/math/direction.hpp"

namespace reflectree {

// By a Lawson fit, 3e-9 off before rounding.
template <class T>
REFLECTREE_INLINE Vec2<T> cos_sin_quarter(T t) {
  if constexpr (std::is_same_v<T, float>) {
    const float s = t * t;
    return {1.f + s * (-0.308425135f + s * (0.0158543239f + s * (-0.0003259365f + s * 3.52876161e-06f))),
            t * (0.785398161f + s * (-0.0807454325f + s * (0.00249000102f - s * 3.59504522e-05f)))};
  } else {
    return {cos(pi_v<T> / T(4) * t), sin(pi_v<T> / T(4) * t)};
  }
}

// By a Lawson fit, 5e-8 off before rounding.
template <class T>
REFLECTREE_INLINE Vec2<T> cos_sin_half(T t) {
  if constexpr (single_precision<T>) {
    const T h = T(0.5f) * t, s = h * h, s2 = s * s;  // Estrin's scheme: short chains
    return {(T(1.f) - s * T(4.93480214f)) +
                s2 * ((T(4.05870916f) - s * T(1.33521206f)) + s2 * (T(0.234937559f) - s * T(0.0243967166f))),
            h * ((T(3.14159264f) - s * T(5.16771009f)) +
                 s2 * ((T(2.55007766f) - s * T(0.598292159f)) + s2 * T(0.0776594082f)))};
  } else {
    return {cos(pi_v<T> / T(2) * t), sin(pi_v<T> / T(2) * t)};
  }
}

template <class T>
T quarter_atan(T t) {
  if constexpr (std::is_same_v<T, float>) {
    const float s = t * t;
    float p = -0.00597563674f;
    for (const float c : {0.0308790214f, -0.0757402948f, 0.126232606f, -0.178501543f, 0.254262416f,
                          -0.424396087f, 1.27323942f}) {
      p = p * s + c;
    }
    return t * p;
  } else {
    return T(4) / pi_v<T> * atan2(t, T(1));
  }
}

// Whole quarters are taken off without rounding; what is left, |x| <= pi/4, enters polynomials with the
// coefficients of Moshier's Cephes, sinf.
inline Vec2<float> on_circle(float turns) {
  const int quarters = int(4 * turns + .5f);
  const float x = 2 * pi * (turns - .25f * float(quarters)), x2 = x * x;
  const float sine = x + x * x2 * (-.166666546f + x2 * (.00833216087f - x2 * .000195152959f));
  const float cosine = 1 + x2 * (-.5f + x2 * (.0416666457f + x2 * (-.00138873163f + x2 * 2.44331571e-05f)));
  const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v); };
  const auto signed_by = [](std::uint32_t v, int two) {
    return std::bit_cast<float>(v ^ (std::uint32_t(two & 2) << 30U));
  };
  const std::uint32_t swap = (bits(sine) ^ bits(cosine)) & (0U - std::uint32_t(quarters & 1));
  return {signed_by(bits(cosine) ^ swap, quarters + 1), signed_by(bits(sine) ^ swap, quarters)};
}

// In [0, pi/2]; 0 at the origin.
// Beyond tan(pi/8) the ratio is turned by pi/4: atan(a) = pi/4 + atan((a - 1) / (a + 1)). The rest is
// x + x^3 P(x^2) with P of degree 3, minimax on |x| <= tan(pi/8) (truncation 2e-8). What is chosen is chosen by
// the sign of a difference, since branches would be coin tosses; of floats or lanes.
template <class T>
requires single_precision<T> REFLECTREE_INLINE T first_quadrant_angle(T y, T x) {
  const T lo = min(x, y), hi = max(x, y);
  const T turn = T(0.41421356f) * hi - lo, steep = x - y;  // where negative
  const T denominator = max(by_sign(turn, hi, lo + hi), T(std::numeric_limits<float>::denorm_min()));
  const T a = by_sign(turn, lo, lo - hi) / denominator;
  const T t = a * a, t2 = t * t;
  const T p = (T(-0.333329553f) + t * T(0.199779261f)) + t2 * (T(-0.1387985f) + t * T(0.0806030888f));
  const T angle = (a + a * (t * p)) + by_sign(turn, T(0), T(0.25f * pi));
  return by_sign(steep, angle, T(0.5f * pi) - angle);
}

inline float first_quadrant_angle(float y, float x) { return first_quadrant_angle<float>(y, x); }

// In [-pi, pi]; 0 at the origin.
template <class T>
requires single_precision<T> REFLECTREE_INLINE T angle_of(T y, T x) {
  x = x + T(0), y = y + T(0);  // -0 is 0
  const T a = first_quadrant_angle(abs(y), abs(x));
  return flip_sign(by_sign(x, a, T(pi) - a), y);
}
inline float angle_of(float y, float x) { return angle_of<float>(y, x); }

// The angle from the normal of a vector with z >= 0, from its squared sine and its cosine.
inline float polar_angle(float sin2_theta, float cos_theta) {
  return first_quadrant_angle(sqrt(sin2_theta), max(cos_theta, 0.f));
}

// Powers of two are taken off in two parts (Cody & Waite 1980); the rest, |r| <= log(2)/2, enters the
// polynomial of Moshier's Cephes, expf.
inline float exp_of_negative(float x) {
  if (!(x > -87)) return std::exp(x);  // below the normal numbers
  const int n = int(1.44269504f * x - .5f);
  const float r = (x - float(n) * .693359375f) + float(n) * 2.12194440e-4f, r2 = r * r;
  const float low = .5f + r * .166666655f, high = .0416657959f + r * .00833345191f;
  const float p = low + r2 * (high + r2 * (.00139819995f + r * .000198756915f));
  return (1 + (r + r2 * p)) * std::bit_cast<float>(std::uint32_t(n + 127) << 23U);
}

// x = 2^n m with m in [sqrt(1/2), sqrt(2)); log m = 2 artanh(s), s = (m - 1) / (m + 1), |s| < 0.172: of its
// series five terms, which leave out 2e-9. The logarithm of 2 comes in two parts, as above.
inline float log_of_positive(float x) {
  if (!(x >= std::numeric_limits<float>::min() && x <= std::numeric_limits<float>::max())) return std::log(x);
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const int n = std::bit_cast<std::int32_t>(bits - 0x3f3504f3U) >> 23;  // from sqrt(1/2) to sqrt(1/2)
  const float m = std::bit_cast<float>(bits - (std::uint32_t(n) << 23U));
  const float s = (m - 1) / (m + 1), s2 = s * s, s4 = s2 * s2;
  const float p = (0.666666667f + s2 * 0.4f) + s4 * (0.285714286f + s2 * 0.222222222f);
  return float(n) * .693359375f + (2 * s + (s * s2 * p - float(n) * 2.12194440e-4f));
}

}  // namespace reflectree
