// SPDX-License-Identifier: Apache-2.0
// Lanes: as many floats as a vector register holds, with the vocabulary of math/scalar.hpp, so that the one
// formula of a model also serves many directions at once. Each lane computes what the float formula
// computes, bit for bit.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "reflectree/math/direction.hpp"
#include "reflectree/math/plain_vector.hpp"

namespace reflectree {

#if defined(__AVX__)
inline constexpr std::size_t lane_count = 8;
#else
inline constexpr std::size_t lane_count = 4;
#endif

namespace detail {
#if defined(__GNUC__) && !defined(REFLECTREE_PLAIN_LANES)
typedef float FloatVector __attribute__((vector_size(4 * lane_count)));
typedef std::int32_t IntVector __attribute__((vector_size(4 * lane_count)));
REFLECTREE_INLINE constexpr FloatVector broadcast(float x) { return x - FloatVector{}; }
REFLECTREE_INLINE FloatVector blend(IntVector c, FloatVector a, FloatVector b) { return c ? a : b; }
#if defined(__AVX__)
REFLECTREE_INLINE FloatVector root(FloatVector a) { return FloatVector(_mm256_sqrt_ps(__m256(a))); }
#elif defined(__SSE2__)
REFLECTREE_INLINE FloatVector root(FloatVector a) { return FloatVector(_mm_sqrt_ps(__m128(a))); }
#else
REFLECTREE_INLINE FloatVector root(FloatVector a) {
  for (std::size_t i = 0; i < lane_count; ++i) a[i] = sqrt(a[i]);
  return a;
}
#endif
#else
using FloatVector = PlainVector<float, lane_count>;
using IntVector = PlainVector<std::int32_t, lane_count>;
constexpr FloatVector broadcast(float x) {
  FloatVector v{};
  for (std::size_t i = 0; i < lane_count; ++i) v[i] = x;
  return v;
}
inline FloatVector blend(IntVector c, FloatVector a, FloatVector b) {
  for (std::size_t i = 0; i < lane_count; ++i) a[i] = c[i] ? a[i] : b[i];
  return a;
}
inline FloatVector root(FloatVector a) {
  for (std::size_t i = 0; i < lane_count; ++i) a[i] = sqrt(a[i]);
  return a;
}
#endif
}  // namespace detail

// One truth per lane: all bits or none.
struct LaneMask {
  detail::IntVector bits;
  REFLECTREE_INLINE friend LaneMask operator&(LaneMask a, LaneMask b) { return {a.bits & b.bits}; }
  REFLECTREE_INLINE friend LaneMask operator|(LaneMask a, LaneMask b) { return {a.bits | b.bits}; }
  bool operator[](std::size_t i) const { return bits[i] != 0; }
};

class Lanes {
 public:
  Lanes() = default;
  // The same number in every lane.
  template <class A>
  requires std::is_arithmetic_v<A> REFLECTREE_INLINE constexpr explicit Lanes(A number)
      : v_(detail::broadcast(static_cast<float>(number))) {}
  REFLECTREE_INLINE explicit Lanes(detail::FloatVector v) : v_(v) {}
  REFLECTREE_INLINE explicit Lanes(detail::IntVector bits) : v_(std::bit_cast<detail::FloatVector>(bits)) {}

  REFLECTREE_INLINE static Lanes load(const float* from) {
    Lanes a;
    std::memcpy(&a.v_, from, sizeof a.v_);
    return a;
  }
  REFLECTREE_INLINE void store(float* to) const { std::memcpy(to, &v_, sizeof v_); }

  REFLECTREE_INLINE detail::FloatVector vector() const { return v_; }
  REFLECTREE_INLINE detail::IntVector bits() const { return std::bit_cast<detail::IntVector>(v_); }
  float operator[](std::size_t i) const { return v_[i]; }

  REFLECTREE_INLINE friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.v_ + b.v_); }
  REFLECTREE_INLINE friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.v_ - b.v_); }
  REFLECTREE_INLINE friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.v_ * b.v_); }
  REFLECTREE_INLINE friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.v_ / b.v_); }
  REFLECTREE_INLINE friend Lanes operator-(Lanes a) { return Lanes(a.bits() ^ Lanes(-0.f).bits()); }
  REFLECTREE_INLINE friend LaneMask operator<(Lanes a, Lanes b) { return {a.v_ < b.v_}; }
  REFLECTREE_INLINE friend LaneMask operator<=(Lanes a, Lanes b) { return {a.v_ <= b.v_}; }
  REFLECTREE_INLINE friend LaneMask operator>(Lanes a, Lanes b) { return {b.v_ < a.v_}; }
  REFLECTREE_INLINE friend LaneMask operator>=(Lanes a, Lanes b) { return {b.v_ <= a.v_}; }
  REFLECTREE_INLINE friend constexpr LaneMask operator==(Lanes a, Lanes b) { return {a.v_ == b.v_}; }

 private:
  detail::FloatVector v_{};
};

template <>
inline constexpr bool single_precision<Lanes> = true;

REFLECTREE_INLINE Lanes select(LaneMask condition, Lanes if_true, Lanes if_false) {
  return Lanes(detail::blend(condition.bits, if_true.vector(), if_false.vector()));
}
// As for floats: the first where the two are equal or not ordered.
REFLECTREE_INLINE Lanes min(Lanes a, Lanes b) { return select(b < a, b, a); }
REFLECTREE_INLINE Lanes max(Lanes a, Lanes b) { return select(a < b, b, a); }
REFLECTREE_INLINE Lanes sqrt(Lanes a) { return Lanes(detail::root(a.vector())); }
REFLECTREE_INLINE Lanes flip_sign(Lanes x, Lanes s) {
  return Lanes(x.bits() ^ (s.bits() & Lanes(-0.f).bits()));
}
REFLECTREE_INLINE Lanes abs(Lanes a) { return flip_sign(a, a); }
REFLECTREE_INLINE Lanes by_sign(Lanes s, Lanes if_positive, Lanes if_negative) {
  return select({s.bits() < detail::IntVector{}}, if_negative, if_positive);
}

// No vector form: lane by lane.
template <class Function, class... A>
inline Lanes each_lane(Function&& f, A... a) {
  float r[lane_count];
  for (std::size_t i = 0; i < lane_count; ++i) r[i] = f(a[i]...);
  return Lanes::load(r);
}
inline Lanes exp(Lanes x) {
  return each_lane([](float a) { return std::exp(a); }, x);
}
inline Lanes log(Lanes x) {
  return each_lane([](float a) { return std::log(a); }, x);
}
inline Lanes log1p(Lanes x) {
  return each_lane([](float a) { return std::log1p(a); }, x);
}
inline Lanes pow(Lanes x, Lanes y) {
  return each_lane([](float a, float b) { return std::pow(a, b); }, x, y);
}
inline Lanes sin(Lanes x) {
  return each_lane([](float a) { return std::sin(a); }, x);
}
inline Lanes cos(Lanes x) {
  return each_lane([](float a) { return std::cos(a); }, x);
}
inline Lanes tan(Lanes x) {
  return each_lane([](float a) { return std::tan(a); }, x);
}
inline Lanes asin(Lanes x) {
  return each_lane([](float a) { return std::asin(a); }, x);
}
inline Lanes acos(Lanes x) {
  return each_lane([](float a) { return std::acos(a); }, x);
}
inline Lanes atan2(Lanes y, Lanes x) {
  return each_lane([](float a, float b) { return std::atan2(a, b); }, y, x);
}

// As in brdf/shading_geometry.hpp, with its branch taken lane by lane.
REFLECTREE_INLINE Vec3<Lanes> sum_of_directions(Vec3<Lanes> wo, Vec3<Lanes> wi) {
  const Vec3<Lanes> h = wo + wi, m = wo - wi;
  const Vec3<Lanes> mended = h - (dot(h, m) / dot(m, m)) * m;
  const LaneMask opposed = dot(wo, wi) < Lanes(0);
  return {select(opposed, mended.x, h.x), select(opposed, mended.y, h.y), select(opposed, mended.z, h.z)};
}

}  // namespace reflectree
