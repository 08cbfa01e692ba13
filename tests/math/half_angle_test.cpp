// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/half_angle.hpp"

#include <gtest/gtest.h>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

Vec3<double> random_above(Pcg32& u) {
  const double z = to_unit_double(u()) + 1e-9, phi = 2 * pi_v<double> * to_unit_double(u());
  const double s = std::sqrt(std::max(0., 1 - z * z));
  return {s * std::cos(phi), s * std::sin(phi), z};
}

TEST(HalfAngle, RoundTrip) {
  Pcg32 u(3);
  for (int i = 0; i < 20000; ++i) {
    const auto wo = random_above(u), wi = random_above(u);
    const auto back = from_half_angle(to_half_angle(wo, wi));
    EXPECT_NEAR(length(back.wo - wo), 0, 1e-13);
    EXPECT_NEAR(length(back.wi - wi), 0, 1e-13);
  }
}

TEST(HalfAngle, AgreesWithTheDefinitionByRotations) {
  Pcg32 u(4);
  for (int i = 0; i < 1000; ++i) {
    const auto wo = random_above(u), wi = random_above(u), wh = normalize(wo + wi);
    const auto a = to_half_angle(wo, wi);
    EXPECT_NEAR(a.theta_h, theta_of(wh), 1e-12);
    EXPECT_NEAR(a.phi_h, phi_of(wh), 1e-12);
    EXPECT_NEAR(std::cos(a.theta_d), dot(wh, wi), 1e-12);
    // d = rotation_y(-theta_h) rotation_z(-phi_h) wi.
    const double c = std::cos(-a.phi_h), s = std::sin(-a.phi_h);
    const Vec3<double> z{c * wi.x - s * wi.y, s * wi.x + c * wi.y, wi.z};
    const double cy = std::cos(-a.theta_h), sy = std::sin(-a.theta_h);
    const Vec3<double> d{cy * z.x + sy * z.z, z.y, cy * z.z - sy * z.x};
    EXPECT_NEAR(d.x, std::sin(a.theta_d) * std::cos(a.phi_d), 1e-12);
    EXPECT_NEAR(d.y, std::sin(a.theta_d) * std::sin(a.phi_d), 1e-12);
  }
}

TEST(HalfAngle, TurningBothDirectionsChangesPhiHAlone) {
  const Vec3<double> wo = direction_from_angles(0.4, 0.3), wi = direction_from_angles(1.1, 1.7);
  const auto a = to_half_angle(wo, wi);
  const auto b = to_half_angle(direction_from_angles(0.4, 0.9), direction_from_angles(1.1, 2.3));
  EXPECT_NEAR(a.theta_h, b.theta_h, 1e-14);
  EXPECT_NEAR(a.theta_d, b.theta_d, 1e-14);
  EXPECT_NEAR(a.phi_d, b.phi_d, 1e-13);
  EXPECT_NEAR(b.phi_h - a.phi_h, 0.6, 1e-14);
}

TEST(HalfAngle, SwappingTurnsPhiDByPi) {
  const Vec3<double> wo = direction_from_angles(0.4, 0.3), wi = direction_from_angles(1.1, 1.7);
  const auto a = to_half_angle(wo, wi), b = to_half_angle(wi, wo);
  EXPECT_NEAR(a.theta_h, b.theta_h, 1e-14);
  EXPECT_NEAR(a.theta_d, b.theta_d, 1e-14);
  EXPECT_NEAR(std::abs(a.phi_d - b.phi_d), pi_v<double>, 1e-13);
}

TEST(HalfAngle, KeepsItsDigitsWhereTheDirectionsNearlyMeet) {
  const HalfAngle<double> a{1.2, 0.7, 1e-9, 2.5};
  const auto pair = from_half_angle(a);
  const auto b = to_half_angle(pair.wo, pair.wi);
  EXPECT_NEAR(b.theta_d, 1e-9, 1e-15);
  EXPECT_NEAR(b.phi_d, 2.5, 1e-6);
}

TEST(HalfAngle, IsFiniteForEqualDirectionsAndAtThePole) {
  const Vec3<double> w = direction_from_angles(0.5, 0.1), n{0, 0, 1};
  EXPECT_EQ(to_half_angle(w, w).theta_d, 0);
  EXPECT_EQ(to_half_angle(n, n).theta_h, 0);
  EXPECT_TRUE(std::isfinite(to_half_angle(n, n).phi_h) && std::isfinite(to_half_angle(n, n).phi_d));
}

// Jacobian of wi given wo in (theta_h, phi_h): d(omega_i) = 4 (wo.wh) d(omega_h), d(omega_h) = sin theta_h.
TEST(HalfAngle, ReflectionHasTheJacobianFourTimesTheCosine) {
  const Vec3<double> wo = direction_from_angles(0.8, 0.0);
  for (const double theta : {0.1, 0.5, 0.9}) {
    for (const double phi : {0.2, 1.9, -2.2}) {
      const double e = 1e-5;
      const auto wi = [&](double t, double p) { return reflect(wo, direction_from_angles(t, p)); };
      const auto du = (0.5 / e) * (wi(theta + e, phi) - wi(theta - e, phi));
      const auto dv = (0.5 / e) * (wi(theta, phi + e) - wi(theta, phi - e));
      const double cos_d = dot(wo, direction_from_angles(theta, phi));
      EXPECT_NEAR(length(cross(du, dv)), 4 * std::abs(cos_d) * std::sin(theta), 1e-8);
    }
  }
}

}  // namespace
}  // namespace reflectree
