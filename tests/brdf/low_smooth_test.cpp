// SPDX-License-Identifier: Apache-2.0
// The oracle of the samplers' tests, itself tested: the closed-form albedo against quadrature over the disk.
#include <gtest/gtest.h>

#include "reflectree/brdf/models/low_smooth.hpp"
#include "reflectree/math/cubature.hpp"

namespace reflectree {
namespace {

// Integral of f over the projected disk in polar coordinates about its centre.
double albedo_by_quadrature(const LowSmooth& f, double cos_theta_o) {
  const Vec3<double> wo{std::sqrt(1 - cos_theta_o * cos_theta_o), 0, cos_theta_o};
  const Integrand integrand = [&](std::span<const Vec2<double>> points, std::span<double> out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double r = points[i].x, phi = points[i].y;
      const Vec3<double> wi{r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r * r)};
      out[i] = r * f(shading_geometry(wo, wi)).r;
    }
  };
  return cubature(integrand, {0, 1, -pi_v<double>, pi_v<double>}, {1e-9, 0, 4'000'000, 16, 16}).value;
}

TEST(LowSmooth, ClosedFormAlbedoAgreesWithQuadrature) {
  for (const float b : {0.5f, 10.f, 1000.f}) {
    for (const double cos_theta_o : {1.0, 0.7, 0.3, 0.01}) {
      const double expected = low_smooth_albedo(2, double(b), cos_theta_o);
      EXPECT_NEAR(albedo_by_quadrature(LowSmooth{{2, 2, 2}, b}, cos_theta_o) / expected, 1, 1e-7)
          << "b " << b << ", cos " << cos_theta_o;
    }
  }
}

// Quadrature sees a hundredth more fall-off, and one percent in b.
TEST(LowSmooth, ClosedFormAlbedoIsOfItsOwnParametersOnly) {
  const double expected = low_smooth_albedo(2, 100, 0.7);
  EXPECT_GT(std::abs(albedo_by_quadrature(LowSmooth{{2, 2, 2}, 100, 1.01f}, 0.7) / expected - 1), 1e-3);
  EXPECT_GT(std::abs(albedo_by_quadrature(LowSmooth{{2, 2, 2}, 101}, 0.7) / expected - 1), 1e-3);
}

}  // namespace
}  // namespace reflectree
