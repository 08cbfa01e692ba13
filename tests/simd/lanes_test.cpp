// SPDX-License-Identifier: Apache-2.0
// Every lane computes what the float formula computes, bit for bit. Compiled twice: with the compiler's
// vectors and with plain loops.
#include <gtest/gtest.h>

#include <limits>

#include "reflectree/brdf/models/all.hpp"
#include "reflectree/math/lanes.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/square/domain_map.hpp"
#include "reflectree/sampler/square/packed_leaf.hpp"

namespace reflectree {
namespace {

std::uint32_t bits(float x) { return std::bit_cast<std::uint32_t>(x); }

// `rounds` times, lane_count random numbers in [lo, hi) an argument: f in lanes against f in floats.
template <class F>
int differences(F&& f, int rounds, float lo = -2, float hi = 2) {
  Pcg32 u(7);
  int different = 0;
  for (int round = 0; round < rounds; ++round) {
    float a[lane_count], b[lane_count], c[lane_count];
    for (std::size_t i = 0; i < lane_count; ++i) {
      a[i] = linear_mix(to_unit_float(u()), lo, hi);
      b[i] = (u() & 7U) == 0 ? a[i] : linear_mix(to_unit_float(u()), lo, hi);  // equal ones too
      c[i] = linear_mix(to_unit_float(u()), lo, hi);
    }
    const Lanes r = f(Lanes::load(a), Lanes::load(b), Lanes::load(c));
    for (std::size_t i = 0; i < lane_count; ++i) different += bits(r[i]) != bits(f(a[i], b[i], c[i]));
  }
  return different;
}

TEST(Lanes, ArithmeticIsThatOfFloats) {
  EXPECT_EQ(differences([](auto a, auto b, auto c) { return (a + b) * c - a / b; }, 1000), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto c) { return -linear_mix(a, b, sqr(c)); }, 1000), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto c) { return clamp(a, min(b, c), max(b, c)); }, 1000), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto) { return abs(a) + sqrt(abs(b)); }, 1000), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto c) { return by_sign(a, b, c); }, 1000), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto) { return flip_sign(a, b); }, 1000), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto c) { return select(a < b, c, select(a == b, a, -c)); }, 1000),
            0);
  EXPECT_EQ(
      differences([](auto a, auto b, auto c) { return select(a <= b, c, a) + select(a >= c, b, c); }, 1000),
      0);
  EXPECT_EQ(differences([](auto a, auto b, auto c) { return select(a > b, c, -a); }, 1000), 0);
}

TEST(Lanes, FunctionsAreThoseOfFloats) {
  EXPECT_EQ(differences([](auto a, auto b, auto) { return exp(a) + log(b) + log1p(b); }, 200, 0.01f, 5), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto) { return pow(a, b) + atan2(a, b); }, 200, 0.01f, 5), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto) { return sin(a) + cos(b) + tan(a); }, 200), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto) { return angle_of(a, b) + angle_of(b, a); }, 1000), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto) { return first_quadrant_angle(a, b); }, 1000, 0, 5), 0);
  EXPECT_EQ(differences([](auto a, auto b, auto) { return asin(a) + acos(b); }, 200, -1, 1), 0);
}

TEST(Lanes, MinimumAndMaximumOfNansAndZerosAreThoseOfFloats) {
  const float odd[] = {0.f, -0.f, 1.f, std::numeric_limits<float>::quiet_NaN(),
                       std::numeric_limits<float>::infinity()};
  for (const float a : odd) {
    for (const float b : odd) {
      EXPECT_EQ(bits(min(Lanes(a), Lanes(b))[1]), bits(min(a, b))) << a << " " << b;
      EXPECT_EQ(bits(max(Lanes(a), Lanes(b))[1]), bits(max(a, b))) << a << " " << b;
      EXPECT_EQ((Lanes(a) < Lanes(b))[0], a < b) << a << " " << b;
      EXPECT_EQ((Lanes(a) == Lanes(b))[0], a == b) << a << " " << b;
    }
  }
}

Direction random_direction(Pcg32& u) {
  const float z = to_unit_float(u()) * 0.999f + 1e-3f, phi = 2 * pi * to_unit_float(u()), s = sqrt(1 - z * z);
  return {s * cos(phi), s * sin(phi), z};
}
template <class Get>
Lanes gather(Get&& get) {
  float a[lane_count];
  for (std::size_t i = 0; i < lane_count; ++i) a[i] = get(i);
  return Lanes::load(a);
}
Vec3<Lanes> gather_directions(const Direction (&w)[lane_count]) {
  return {gather([&](std::size_t i) { return w[i].x; }), gather([&](std::size_t i) { return w[i].y; }),
          gather([&](std::size_t i) { return w[i].z; })};
}

// Worst relative difference between a model in lanes and in floats.
template <class M>
float worst_difference(const M& model) {
  Pcg32 u(11);
  float worst = 0;
  for (int round = 0; round < 500; ++round) {
    Direction wo[lane_count], wi[lane_count];
    for (Direction& w : wo) w = random_direction(u);
    for (Direction& w : wi) w = random_direction(u);
    wi[0] = {-wo[0].x, -wo[0].y, wo[0].z};
    const RgbT<Lanes> v = model(shading_geometry(gather_directions(wo), gather_directions(wi)));
    for (std::size_t i = 0; i < lane_count; ++i) {
      const Rgb f = model(shading_geometry(wo[i], wi[i]));
      worst = max(worst, abs(v.r[i] - f.r) / max(f.r, 1e-30f));
      worst = max(worst, abs(v.g[i] - f.g) / max(f.g, 1e-30f));
      worst = max(worst, abs(v.b[i] - f.b) / max(f.b, 1e-30f));
    }
  }
  return worst;
}

TEST(Lanes, TheOneFormulaOfEachModelServesLanes) {
  for_each_model(
      []<class M>(std::type_identity<M>) { EXPECT_EQ(worst_difference(M{}), 0) << M::describe().name; });
  EXPECT_EQ(worst_difference(Ggx{0.05f}), 0);
}

TEST(Lanes, PointsAreLiftedAsByFloats) {
  Pcg32 u(13);
  for (const DomainKind kind : {DomainKind::projected_disk, DomainKind::equal_area, DomainKind::half_vector,
                                DomainKind::back_vector, DomainKind::stretched, DomainKind::mirror_vector,
                                DomainKind::normal_vector, DomainKind::scaled_star}) {
    const Domain domain{kind, Symmetry::none, 1.5f, 1, 0.3f, 0.6f};
    int different = 0;
    for (int round = 0; round < 300; ++round) {
      Direction wo[lane_count];
      Vec2<float> p[lane_count];
      for (std::size_t i = 0; i < lane_count; ++i) {
        const Direction w = random_direction(u);
        wo[i] = {sqrt(sin2_theta(w)), 0, w.z};
        p[i] = {2 * to_unit_float(u()) - 1, 2 * to_unit_float(u()) - 1};
      }
      const Vec2<Lanes> at{gather([&](std::size_t i) { return p[i].x; }),
                           gather([&](std::size_t i) { return p[i].y; })};
      const auto lifted = detail::lift_point(domain, gather_directions(wo), at);
      for (std::size_t i = 0; i < lane_count; ++i) {
        const DomainPoint one = lift(domain, wo[i], p[i]);
        different += bits(lifted.projected_area[i]) != bits(one.projected_area);
        different += bits(lifted.geometry.wi.x[i]) != bits(one.geometry.wi.x);
        different += bits(lifted.geometry.wi.y[i]) != bits(one.geometry.wi.y);
        different += bits(lifted.geometry.wi.z[i]) != bits(one.geometry.wi.z);
        different += bits(lifted.geometry.cos_theta_d[i]) != bits(one.geometry.cos_theta_d);
      }
    }
    EXPECT_EQ(different, 0) << name_of(kind);
  }
}

}  // namespace
}  // namespace reflectree
