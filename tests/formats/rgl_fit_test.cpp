// SPDX-License-Identifier: Apache-2.0
// RGL files that are baked: read back as they were fitted, near to the material, with its symmetries.
#include "reflectree/formats/rgl_fit.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "../error_words.hpp"
#include "measured_data.hpp"
#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/lambert.hpp"
#include "reflectree/brdf/models/ward.hpp"
#include "reflectree/formats/rgl.hpp"

namespace reflectree {
namespace {

constexpr RglFitOptions small{8, 5, 64, 16};

Ward brushed() {
  Ward ward;
  ward.alpha_x = 0.15f, ward.alpha_y = 0.4f;
  return ward;
}

// Turned about the normal.
template <class F>
AnyBrdf turned_by(const F& f, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return [=](Direction wo, Direction wi) {
    const auto back = [=](Direction w) { return Direction{c * w.x + s * w.y, c * w.y - s * w.x, w.z}; };
    return f(shading_geometry(back(wo), back(wi)));
  };
}

Rgb without_symmetry(Direction wo, Direction wi) {
  const Direction h = normalize(wo + wi);
  const float a = h.x / 0.3f - 0.3f * h.y, b = h.y / 0.5f + 0.1f * wo.x;
  return {0.2f + 0.1f * wi.x * wo.y + std::exp(-(a * a + b * b)) * (1 + 0.3f * wo.y), 0.3f,
          0.1f * (1 + wi.x)};
}

TEST(RglFit, WhatIsWrittenIsReadBack) {
  for (const AnyBrdf& f : {AnyBrdf(Ggx{0.3f, {1, 0.8f, 0.3f}}), AnyBrdf(brushed())}) {
    const RglFit fit = fit_rgl(f, small);
    const Bytes bytes = write_rgl(fit, "a material");
    const RglWideFields back = read_rgl_wide_fields(bytes, "m");
    EXPECT_EQ(back.phi_o, fit.fields.phi_o);
    EXPECT_EQ(back.theta_o, fit.fields.theta_o);
    EXPECT_EQ(back.reduction, fit.fields.reduction);
    EXPECT_EQ(back.sigma.values, fit.fields.sigma.values);
    EXPECT_EQ(back.ndf.values, fit.fields.ndf.values);
    EXPECT_EQ(back.vndf, fit.fields.vndf);
    EXPECT_EQ(back.colours, fit.fields.colours);
    EXPECT_TRUE(back.jacobian);
    EXPECT_EQ(fit.luminance.size() * 3, back.colours.size());
  }
  EXPECT_NO_THROW(read_rgl(write_rgl(fit_rgl(Lambert{}, small), ""), "m"))
      << "isotropic files suit the quick table";
}

double error_of(const AnyBrdf& f, const RglFitOptions& options = {}) {
  return rgl_fit_error(RglWideTable(fit_rgl(f, options).fields), f);
}

TEST(RglFit, IsNearTheMaterial) {
  EXPECT_LT(error_of(Lambert{}), 0.02);
  EXPECT_LT(error_of(Ggx{0.3f, {1, 0.8f, 0.3f}}), 0.01);
  EXPECT_LT(error_of(Ggx{0.1f, {1, 0.8f, 0.3f}}), 0.01);
  EXPECT_LT(error_of(brushed(), {12, 7, 96, 24}), 0.05);
  EXPECT_LT(error_of(AnyBrdf(without_symmetry), {10, 5, 64, 24}), 0.05);
  // Finer tables are nearer.
  EXPECT_LT(error_of(Ggx{0.3f, {1, 0.8f, 0.3f}}, {32, 9, 128, 64}),
            error_of(Ggx{0.3f, {1, 0.8f, 0.3f}}, small));
}

TEST(RglFit, FindsTheSymmetries) {
  const RglFitOptions tiny{4, 3, 16, 6};
  const auto shape = [&](const AnyBrdf& f) {
    const RglWideFields fields = fit_rgl(f, tiny).fields;
    return std::pair<int, std::size_t>(fields.reduction, fields.phi_o.size());
  };
  using Shape = std::pair<int, std::size_t>;
  EXPECT_EQ(shape(Lambert{}), Shape(1, 1));
  EXPECT_EQ(shape(brushed()), Shape(4, 3));
  EXPECT_EQ(shape(turned_by(brushed(), 0.5f * pi)), Shape(4, 3));
  EXPECT_EQ(shape(turned_by(brushed(), 0.6f)), Shape(2, 5));
  EXPECT_EQ(shape(AnyBrdf(without_symmetry)), Shape(1, 9));
  // A function that does not say what it is.
  EXPECT_EQ(shape(AnyBrdf([](Direction wo, Direction wi) { return 0.2f + 0.1f * dot(wo, wi); })),
            Shape(1, 1));
}

// The normalisation of Dupuy and Jakob: the projected area of the normal is 1, and sigma is the projected
// area of the distribution: for every normal alike, (1 + cos) / 2.
TEST(RglFit, SigmaIsTheProjectedArea) {
  const RglWideFields fields = fit_rgl(AnyBrdf([](Direction, Direction) { return 0.3f; }), small).fields;
  EXPECT_NEAR(fields.sigma.values[0], 1, 1e-3);
  const std::size_t last = std::size_t(fields.sigma.width) - 1;
  EXPECT_GT(fields.sigma.values[last], 0.1);
  EXPECT_LT(fields.sigma.values[last], 0.7);
  double area = 0;
  for (std::size_t i = 0; i <= last; ++i) {
    const double u = double(i) / double(last), theta = 0.5 * pi_v<double> * u * u;
    area += double(fields.ndf.values[i]) * std::cos(theta) * std::sin(theta) * 2 * pi_v<double> *
            pi_v<double> * u / double(last);
  }
  EXPECT_NEAR(area, 1, 1e-2);
}

// Where nothing may be drawn readers would divide by 0.
TEST(RglFit, EveryDensityHasMass) {
  for (const AnyBrdf& f : {AnyBrdf([](Direction, Direction) { return 0.f; }),
                           AnyBrdf([](Direction wo, Direction) { return wo.z > 0.5f ? 1.f : 0.f; })}) {
    const RglFit fit = fit_rgl(f, small);
    const std::size_t slices = fit.fields.theta_o.size(), warp = fit.fields.vndf.size() / slices,
                      colours = fit.luminance.size() / slices;
    for (std::size_t s = 0; s < slices; ++s) {
      const auto mass = [s](const std::vector<float>& table, std::size_t size) {
        const auto first = table.begin() + std::ptrdiff_t(s * size);
        return std::accumulate(first, first + std::ptrdiff_t(size), 0.0);
      };
      EXPECT_GT(mass(fit.fields.vndf, warp), 0);
      EXPECT_GT(mass(fit.luminance, colours), 0);
    }
  }
}

TEST(RglFit, RefusesWhatItCannotHold) {
  const auto error = [](const AnyBrdf& f) -> std::string { return error_words([&] { fit_rgl(f, small); }); };
  EXPECT_EQ(error(channel_brdf(4, [](Direction, Direction, std::span<float> out) { out[0] = 1; })),
            "lambda: 4 channels: RGL files are written with 3; bake a BRDF of 1 or 3 channels");
  EXPECT_EQ(error(AnyBrdf([](Direction, Direction wi) { return wi.z < 0.3f ? std::nanf("") : 1.f; })),
            "lambda: negative or not finite at a node; mend the BRDF before baking it");
  Host impatient;
  impatient.cancelled = [] { return true; };
  EXPECT_THROW(fit_rgl(Lambert{}, small, impatient), Cancelled);
}

}  // namespace
}  // namespace reflectree
