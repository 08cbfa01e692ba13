// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/frame.hpp"

#include <gtest/gtest.h>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

template <class T>
Vec3<T> random_direction(Pcg32& u) {
  const double z = 2 * to_unit_double(u()) - 1;
  const double phi = 2 * pi_v<double> * to_unit_double(u()), s = std::sqrt(1 - z * z);
  return {T(s * std::cos(phi)), T(s * std::sin(phi)), T(z)};
}

template <class T>
void expect_orthonormal(Vec3<T> n, T tolerance) {
  const LocalFrame<T> f = frame_from_normal(n);
  EXPECT_NEAR(length(f.s), T(1), tolerance);
  EXPECT_NEAR(length(f.t), T(1), tolerance);
  EXPECT_NEAR(dot(f.s, f.t), T(0), tolerance);
  EXPECT_NEAR(dot(f.s, n), T(0), tolerance);
  EXPECT_NEAR(dot(f.t, n), T(0), tolerance);
  EXPECT_NEAR(length(cross(f.s, f.t) - n), T(0), tolerance) << "left-handed";
}

TEST(Frame, IsOrthonormalAndRightHanded) {
  Pcg32 u(1);
  for (int i = 0; i < 10000; ++i) {
    expect_orthonormal(random_direction<double>(u), 1e-14);
    expect_orthonormal(random_direction<float>(u), 1e-6f);
  }
}

TEST(Frame, HoldsAtThePolesAndNextToThem) {
  for (const float z : {1.f, -1.f}) {
    expect_orthonormal(Vec3<float>{0, 0, z}, 0.f);
    expect_orthonormal(Vec3<float>{1e-20f, -1e-30f, z}, 1e-6f);
    expect_orthonormal(Vec3<float>{3e-4f, 2e-4f, z}, 1e-6f);
  }
  expect_orthonormal(Vec3<float>{1, 0, 0.f}, 1e-6f);
  expect_orthonormal(Vec3<float>{0, 1, -0.f}, 1e-6f);
}

TEST(Frame, OfTheAxisIsTheAxes) {
  const LocalFrame<float> f = frame_from_normal(Vec3<float>{0, 0, 1});
  EXPECT_EQ(f.s, (Vec3<float>{1, 0, 0}));
  EXPECT_EQ(f.t, (Vec3<float>{0, 1, 0}));
}

TEST(Frame, LocalAndWorldAreInverse) {
  Pcg32 u(2);
  for (int i = 0; i < 1000; ++i) {
    const auto n = random_direction<double>(u), w = random_direction<double>(u);
    const auto f = frame_from_normal(n);
    EXPECT_NEAR(length(to_world(f, to_local(f, w)) - w), 0, 1e-14);
    EXPECT_NEAR(to_local(f, w).z, dot(w, n), 1e-14);
    EXPECT_NEAR(to_local(f, n).z, 1, 1e-14);
  }
}

}  // namespace
}  // namespace reflectree
