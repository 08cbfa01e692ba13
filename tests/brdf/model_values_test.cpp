// SPDX-License-Identifier: Apache-2.0
// Every model against values computed independently from the papers (values/MODEL.py, reference_values.py).
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "random_models.hpp"
#include "reflectree/brdf/material/material.hpp"

namespace reflectree {
namespace {

template <class M>
RgbT<double> value(const M& model, double theta_o, double phi_o, double theta_i, double phi_i) {
  return model(
      shading_geometry(direction_from_angles(theta_o, phi_o), direction_from_angles(theta_i, phi_i)));
}

double relative_error(double x, double expected) { return std::abs(x - expected) / std::abs(expected); }

// Where a value lies below 1e-30 of the unit, exponents of 1e5 leave no digits to compare.
double error_of(double x, double expected) {
  return std::abs(expected) < 1e-30 ? std::abs(x - expected) : relative_error(x, expected);
}

// VALUES of values/MODEL.py: a material, then lines of theta_o phi_o theta_i phi_i  r g b.
template <class M>
void expect_reference_values() {
  const std::string name(M::describe().name);
  std::ifstream file(REFLECTREE_SOURCE "/values/" + name + ".py");
  ASSERT_TRUE(file) << name << " has no reference values: write values/" << name
                    << ".py and run reference_values.py";
  std::string line;
  while (std::getline(file, line) && line != "VALUES = \"\"\"") continue;
  M model;
  int values = 0;
  while (std::getline(file, line) && line != "\"\"\"") {
    if (line[0] != ' ') {
      const MaterialTerm term = parse_material(line).terms.at(0);
      ASSERT_EQ(term.model, name) << line;
      model = model_from_values<M>(term.values);
      continue;
    }
    double theta_o = 0, phi_o = 0, theta_i = 0, phi_i = 0, r = 0, g = 0, b = 0;
    std::istringstream in(line);
    ASSERT_TRUE(in >> theta_o >> phi_o >> theta_i >> phi_i >> r >> g >> b) << name << ": " << line;
    const RgbT<double> v = value(model, theta_o, phi_o, theta_i, phi_i);
    EXPECT_LT(std::max({error_of(v.r, r), error_of(v.g, g), error_of(v.b, b)}), 1e-9)
        << model.traits().name << " at " << theta_o << " " << theta_i;
    ++values;
  }
  EXPECT_GE(values, 5) << name << ": run reference_values.py";
}

TEST(ModelValues, AgreeWithThePapersFormulas) {
  for_each_model([]<class M>(std::type_identity<M>) { expect_reference_values<M>(); });
}

// The values tell neighbouring models apart: a parameter one part in a thousand off is seen.
TEST(ModelValues, RejectAnotherParameter) {
  const RgbT<double> right = value(Ggx{0.125f, {1, 0.75f, 0.25f}}, 0.75, 0.5, 0.71875, 3.625);
  const RgbT<double> wrong = value(Ggx{0.125125f, {1, 0.75f, 0.25f}}, 0.75, 0.5, 0.71875, 3.625);
  EXPECT_GT(relative_error(wrong.r, right.r), 1e-4);
}

// In float, too, the peak of the sharpest lobe has its value. GGX: D = 1 / (pi alpha^2),
// G = 1 / sqrt(1 + alpha^2 tan^2); Ward: 1 / (4 pi alpha^2 cos^2); Phong: (n + 2) / (2 pi).
TEST(ModelValues, FloatKeepsTheSharpestPeak) {
  for (const float theta : {0.f, 0.5f, 1.f, 1.5f}) {
    const Direction wo = direction_from_angles(theta, 0.f);
    const ShadingGeometry<float> g = shading_geometry(wo, Direction{-wo.x, -wo.y, wo.z});
    const double cos2 = sqr(double(wo.z)), a2 = sqr(double(0.001f));
    const double smith = 1 / std::sqrt(1 + a2 * (1 - cos2) / cos2);
    const double facets = 1 / (4 * pi_v<double> * a2 * cos2);
    EXPECT_LT(relative_error(double(Ggx{0.001f, {1, 1, 1}}(g).r), facets * smith), 1e-6);
    EXPECT_LT(relative_error(double(Ward{{0, 0, 0}, {1, 1, 1}, 0.001f, 0.001f}(g).r), facets), 1e-6);
    EXPECT_LT(relative_error(double(Phong{{0, 0, 0}, {1, 1, 1}, 1e6f}(g).r), 1000002 / (2 * pi_v<double>)),
              1e-6);
  }
}

}  // namespace
}  // namespace reflectree
