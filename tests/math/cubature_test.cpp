// SPDX-License-Identifier: Apache-2.0
#include "reflectree/math/cubature.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

template <class F>
Integrand batched(F f) {
  return [f](std::span<const Vec2<double>> p, std::span<double> out) {
    for (std::size_t i = 0; i < p.size(); ++i) out[i] = f(p[i].x, p[i].y);
  };
}

double power_integral(int n, double a, double b) {
  return (std::pow(b, n + 1) - std::pow(a, n + 1)) / (n + 1);
}

TEST(Cubature, IsExactForEveryMonomialUpToDegreeSeven) {
  const CubatureBox r{-0.3, 1.7, 0.2, 0.9};
  for (int a = 0; a <= 8; ++a) {
    for (int b = 0; a + b <= 8; ++b) {
      CubatureOptions one_region;
      one_region.cells_x = one_region.cells_y = 1;
      one_region.max_evaluations = 17;
      const auto f = batched([a, b](double x, double y) { return std::pow(x, a) * std::pow(y, b); });
      const auto result = cubature(f, r, one_region);
      const double exact = power_integral(a, r.x0, r.x1) * power_integral(b, r.y0, r.y1);
      EXPECT_EQ(result.evaluations, 17u);
      if (a + b <= 7) {
        EXPECT_NEAR(result.value, exact, 1e-13 * std::abs(exact)) << a << ' ' << b;
      } else if (a == 8) {
        EXPECT_GT(std::abs(result.value - exact), 1e-5) << "degree 8 should not be exact";
      }
    }
  }
}

// The error estimate is the difference of the two rules: zero to degree 5 and no further. With the
// previous test this detects any single wrong weight or node.
TEST(Cubature, ErrorEstimateVanishesUpToDegreeFive) {
  CubatureOptions one_region;
  one_region.cells_x = one_region.cells_y = 1;
  one_region.max_evaluations = 17;
  for (int a = 0; a <= 6; ++a) {
    for (int b = 0; a + b <= 6; ++b) {
      const auto f = batched([a, b](double x, double y) { return std::pow(x, a) * std::pow(y, b); });
      const auto result = cubature(f, {-1, 1, -1, 1}, one_region);
      if (a + b <= 5) {
        EXPECT_LT(result.error, 1e-13);
      } else if (a % 2 == 0) {
        EXPECT_GT(result.error, 1e-3) << a << ' ' << b;
      }
    }
  }
}

// The planted twin: 1 % on the weight of one orbit is the same as 1 % on the integrand at its points,
// which the monomials must notice.
TEST(Cubature, AWrongWeightWouldBeSeen) {
  CubatureOptions one_region;
  one_region.cells_x = one_region.cells_y = 1;
  one_region.max_evaluations = 17;
  const std::size_t first_of_orbit[] = {0, 1, 5, 9, 13, 17};
  for (std::size_t orbit = 0; orbit < 5; ++orbit) {
    const Integrand bent = [&](std::span<const Vec2<double>>, std::span<double> out) {
      for (std::size_t i = 0; i < out.size(); ++i) {
        out[i] = i >= first_of_orbit[orbit] && i < first_of_orbit[orbit + 1] ? 1.01 : 1.0;
      }
    };
    EXPECT_GT(std::abs(cubature(bent, {0, 1, 0, 1}, one_region).value - 1), 1e-4) << orbit;
  }
}

struct Peak {
  double x, y, width;
};
double gaussian_integral(const Peak& p) {
  const auto part = [&](double c) {
    const double k = p.width * std::sqrt(2.);
    return p.width * std::sqrt(pi_v<double> / 2) * (std::erf((1 - c) / k) + std::erf(c / k));
  };
  return part(p.x) * part(p.y);
}

TEST(Cubature, ErrorBoundHoldsForGaussianPeaks) {
  Pcg32 u(1);
  for (const double width : {0.3, 0.1, 0.03, 0.01}) {
    for (int i = 0; i < 20; ++i) {
      const Peak p{to_unit_double(u()), to_unit_double(u()), width};
      const auto f = batched([p](double x, double y) {
        return std::exp(-0.5 * (sqr((x - p.x) / p.width) + sqr((y - p.y) / p.width)));
      });
      CubatureOptions options;
      options.relative_tolerance = 1e-7;
      options.cells_x = options.cells_y = 16;
      const auto result = cubature(f, {0, 1, 0, 1}, options);
      EXPECT_TRUE(result.converged);
      EXPECT_LE(std::abs(result.value - gaussian_integral(p)), result.error)
          << width << ' ' << p.x << ' ' << p.y;
      EXPECT_LT(result.evaluations, 60000u);
    }
  }
}

// A peak of relative width 1e-3 with the heavy tail of a microfacet lobe is found from 16 cells.
TEST(Cubature, FindsAnOffCentrePeakOfWidthOneThousandth) {
  Pcg32 u(2);
  for (int i = 0; i < 50; ++i) {
    const double cx = to_unit_double(u()), cy = to_unit_double(u()), w = 1e-3;
    // Separable Cauchy peak: product of arctangents.
    const auto f =
        batched([=](double x, double y) { return 1 / ((w * w + sqr(x - cx)) * (w * w + sqr(y - cy))); });
    const auto part = [w](double c) { return (std::atan((1 - c) / w) + std::atan(c / w)) / w; };
    CubatureOptions options;
    options.relative_tolerance = 1e-6;
    const auto result = cubature(f, {0, 1, 0, 1}, options);
    const double exact = part(cx) * part(cy);
    EXPECT_TRUE(result.converged) << result.evaluations;
    EXPECT_LE(std::abs(result.value - exact), result.error) << cx << ' ' << cy;
    EXPECT_NEAR(result.value / exact, 1, 1e-6);
  }
}

// Loew et al. 2012 with C = F = 1: 1 / (1 + B |x + x_o|^2) over the unit disk has a closed form.
TEST(Cubature, AgreesWithTheLowSmoothLobe) {
  for (const double b : {1., 100., 1e4, 1e6, 1e8}) {
    for (const double r : {0., 0.3, 0.9, 0.99999}) {
      const double exact =
          pi_v<double> / b *
          std::log((1 + b * (1 - r * r) + std::sqrt(1 + 2 * b * (1 + r * r) + sqr(b * (1 - r * r)))) / 2);
      const auto f = batched([b, r](double s, double phi) {  // polar coordinates, dx dy = s ds dphi
        return s / (1 + b * (sqr(s * std::cos(phi) + r) + sqr(s * std::sin(phi))));
      });
      CubatureOptions options;
      options.relative_tolerance = 1e-7;
      const auto result = cubature(f, {0, 1, -pi_v<double>, pi_v<double>}, options);
      EXPECT_TRUE(result.converged) << b << ' ' << r;
      EXPECT_LE(std::abs(result.value - exact), std::max(result.error, 1e-13 * exact)) << b << ' ' << r;
    }
  }
}

// Bilinear tables have kinks along grid lines; here along random oblique lines, |a x + b y - c|.
TEST(Cubature, ErrorBoundHoldsForKinks) {
  Pcg32 u(3);
  int outside = 0;
  constexpr int trials = 300;
  for (int i = 0; i < trials; ++i) {
    const double phi = 0.1 + (pi_v<double> / 2 - 0.2) * to_unit_double(u());
    const double a = std::cos(phi), b = (i % 2 == 0 ? 1 : -1) * std::sin(phi);
    const double c = a * to_unit_double(u()) + b * to_unit_double(u());
    const auto f = batched([=](double x, double y) { return std::abs(a * x + b * y - c); });
    // Second antiderivative in x and y of |t|, t = a x + b y - c, is |t|^3 / (6 a b).
    const auto corner = [=](double x, double y) {
      const double t = std::abs(a * x + b * y - c);
      return t * t * t / (6 * a * b);
    };
    const double exact = corner(1, 1) - corner(0, 1) - corner(1, 0) + corner(0, 0);
    CubatureOptions options;
    options.relative_tolerance = 1e-5;
    const auto result = cubature(f, {0, 1, 0, 1}, options);
    EXPECT_TRUE(result.converged);
    EXPECT_NEAR(result.value, exact, 5e-5 * exact);
    outside += std::abs(result.value - exact) > result.error;
  }
  EXPECT_LE(outside, trials / 20);
}

TEST(Cubature, ErrorBoundHoldsForJumps) {
  Pcg32 u(4);
  int outside = 0;
  constexpr int trials = 60;
  for (int i = 0; i < trials; ++i) {
    const double cut = 0.1 + 0.9 * to_unit_double(u());
    const auto f = batched([cut](double x, double y) { return x * x + y * y < cut ? 1.0 : 0.0; });
    CubatureOptions options;
    options.relative_tolerance = 3e-4;
    const auto result = cubature(f, {0, 1, 0, 1}, options);
    EXPECT_TRUE(result.converged);
    EXPECT_NEAR(result.value, pi_v<double> / 4 * cut, 3e-3 * cut);
    outside += std::abs(result.value - pi_v<double> / 4 * cut) > result.error;
  }
  EXPECT_LE(outside, trials / 20);
}

TEST(Cubature, SplitsAcrossTheVariationOnly) {
  const auto ridge = batched([](double x, double) { return 1 / (1e-6 + sqr(x - 0.3)); });
  CubatureOptions options;
  options.cells_x = options.cells_y = 1;
  std::vector<CubatureRegion> regions;
  const auto result = cubature(ridge, {0, 1, 0, 1}, options, regions);
  EXPECT_TRUE(result.converged);
  for (const auto& r : regions) EXPECT_EQ(r.box.y1 - r.box.y0, 1);
}

TEST(Cubature, RegionsTileTheDomain) {
  const auto f = batched([](double x, double y) { return 1 / (1e-4 + sqr(x - 0.3) + sqr(y - 0.6)); });
  std::vector<CubatureRegion> regions;
  const auto result = cubature(f, {0, 1, 0, 1}, {}, regions);
  double area = 0, value = 0, error = 0;
  for (const auto& r : regions) {
    area += (r.box.x1 - r.box.x0) * (r.box.y1 - r.box.y0);
    value += r.value;
    error += r.error;
  }
  EXPECT_NEAR(area, 1, 1e-12);
  EXPECT_NEAR(value, result.value, 1e-9 * result.value);
  EXPECT_NEAR(error, result.error, 1e-6 * result.error);
}

TEST(Cubature, StopsAtTheLimitAndSaysSo) {
  const auto f = batched([](double x, double y) { return std::sin(1e4 * x * y) + 1; });
  CubatureOptions options;
  options.relative_tolerance = 1e-12;
  options.max_evaluations = 10000;
  const auto result = cubature(f, {0, 1, 0, 1}, options);
  EXPECT_FALSE(result.converged);
  EXPECT_LE(result.evaluations, 10000u);
  EXPECT_GT(result.error, 1e-12);
}

TEST(Cubature, ReportsValuesThatAreNotFinite) {
  const auto f = batched([](double x, double) { return x < 0.5 ? 1 : std::nan(""); });
  const auto result = cubature(f, {0, 1, 0, 1});
  EXPECT_FALSE(result.converged);
  EXPECT_TRUE(std::isinf(result.error));
}

TEST(Cubature, OfZeroIsZero) {
  const auto result = cubature(batched([](double, double) { return 0.; }), {0, 1, 0, 1});
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.value, 0);
}

}  // namespace
}  // namespace reflectree
