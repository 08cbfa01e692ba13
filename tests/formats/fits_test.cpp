// SPDX-License-Identifier: Apache-2.0
// NBRDF networks, SGD and ABC fits against fits_reference.py, and the tables that hold them.
#include <gtest/gtest.h>

#include <algorithm>

#include "../error_words.hpp"
#include "measured_data.hpp"
#include "reference_values.hpp"
#include "reflectree/brdf/models/sgd.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/format_table.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/measured_facts.hpp"
#include "reflectree/formats/model_tables.hpp"
#include "synthetic.hpp"

namespace reflectree {
namespace {

// |f - reference| / (|reference| + 1e-3), sorted, over pairs that do not graze.
std::vector<double> errors_of(const std::string& file, const std::string& material, bool swap = false) {
  const Pairs pairs = random_pairs(500, 0.3f, 21);
  const std::vector<double> reference = reference_values("fits_reference.py", {file, material}, pairs);
  const AnyBrdf f = load_brdf(file, material);
  std::vector<float> values(pairs.wo.size() * 3);
  f.eval(swap ? pairs.wi : pairs.wo, swap ? pairs.wo : pairs.wi, values);
  std::vector<double> all;
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    double difference = 0, size = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double wanted = reference[3 * i + c];
      difference = std::max(difference, std::abs(double(values[3 * i + c]) - wanted));
      size = std::max(size, wanted);
    }
    if (min(pairs.wo[i].z, pairs.wi[i].z) > 0.01f) all.push_back(difference / (size + 1e-3));
  }
  std::sort(all.begin(), all.end());
  return all;
}

// The masking of sharp SGD fits has a cliff on which roundings of the directions alone cost percents.
void expect_close(const std::string& file, const std::string& material) {
  const std::vector<double> errors = errors_of(file, material);
  EXPECT_LT(errors[errors.size() * 99 / 100], 2e-4) << material;
  EXPECT_LT(errors.back(), 0.05) << material;
}

TEST(Fits, SyntheticTablesAgreeWithTheReference) {
  const TemporaryFolder folder("fits");
  write_file_atomically(folder / "n.csv", synthetic::neural_csv());
  write_file_atomically(folder / "s.csv", synthetic::sgd_csv());
  write_file_atomically(folder / "a.csv", synthetic::abc_csv());
  expect_close(folder / "n.csv", "one");
  expect_close(folder / "n.csv", "two");
  expect_close(folder / "s.csv", "varnish");
  expect_close(folder / "a.csv", "bronze");
  // Networks are not reciprocal: swapped arguments must show.
  EXPECT_GT(errors_of(folder / "n.csv", "one", true).back(), 1e-2);
}

// Masking that vanishes at the horizon, over a cosine that does, too: in float the angle's steps of 1e-7
// would be jumps of 1 % here.
TEST(Fits, MaskingIsSmoothNearTheHorizon) {
  SgdChannel channel;
  channel.ks = 1, channel.lambda = 0.3403f, channel.theta_0 = 0.2f;
  const Sgd sgd{"grazing", {channel, channel, channel}};
  for (int i = 0; i < 1000; ++i) {
    const float z = 1e-5f + 1e-8f * float(i);
    const Direction wo{sqrt(1 - z * z), 0, z}, wi{-0.6f, 0, 0.8f};
    const Vec3<double> o{wo.x, wo.y, wo.z}, d{wi.x, wi.y, wi.z};
    const double fine = sgd(shading_geometry(o, d)).g;
    ASSERT_NEAR(double(sgd(shading_geometry(wo, wi)).g) / fine, 1, 1e-4) << z;
  }
}

// The fitted Fresnel term falls below 0 near theta_d = 0: there the lobe darkens the ground, down to f = 0.
TEST(Fits, ANegativeFresnelTermDarkensAndTheValueIsCut) {
  SgdChannel dark, faint;
  dark.kd = 0.2f, dark.ks = 1, dark.f0 = 0.1f, dark.f1 = 0.4f, dark.alpha = 0.3f, dark.kappa = 3;
  faint = dark, faint.ks = 0.01f;
  const Sgd sgd{"dark", {dark, faint, {}}};
  const Direction normal{0, 0, 1};
  const ShadingGeometry<float> g = shading_geometry(normal, normal);
  EXPECT_LT(sgd.unclipped(g).r, 0);
  EXPECT_EQ(sgd(g).r, 0);
  const float x = faint.alpha, lobe = 3 / pi * std::exp(-x) / x;  // D at the peak; p = 1, G = 1
  EXPECT_NEAR(sgd(g).g, (0.2f + 0.01f * -0.3f * lobe) / pi, 1e-6f);
  EXPECT_LT(sgd(g).g, 0.2f / pi - 1e-4f) << "a term cut at 0 would leave the ground";
}

TEST(Fits, FactsCountValuesBelowZero) {
  const TemporaryFolder folder("fits");
  std::string table = synthetic::sgd_csv();
  EXPECT_EQ(measured_facts(synthetic::as_bytes(table), "t")->clipped, (std::array<std::uint64_t, 3>{}));
  table.replace(table.find("varnish,0.05,"), 13, "varnish,0,");           // no ground in red
  table.replace(table.find(",0.9,0.25,0.6,0.1,"), 18, ",0,0.25,0.6,1,");  // F = -c + (1 - c)^5
  const MeasuredFacts facts = *measured_facts(synthetic::as_bytes(table), "t");
  EXPECT_GT(facts.clipped[0], facts.pairs / 8);
  EXPECT_EQ(facts.clipped[1] + facts.clipped[2], 0U);
  EXPECT_EQ(facts.entries, 0U);
  // A network whose last biases are low is negative somewhere.
  const std::string network = synthetic::neural_csv();
  const MeasuredFacts of_network = *measured_facts(synthetic::as_bytes(network), "n", "one");
  const NeuralBrdf f = make_neural(read_parameter_table(synthetic::as_bytes(network), "n"),
                                   read_parameter_table(synthetic::as_bytes(network), "n").row("one"), "one");
  const Pairs pairs = random_pairs(4000, 0.5f, 3);
  std::array<double, 3> below{};
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const auto g = shading_geometry(pairs.wo[i], pairs.wi[i]);
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(channel_value(f(g), c), std::max(channel_value(f.unclipped(g), c), 0.f));
      below[std::size_t(c)] += channel_value(f.unclipped(g), c) < 0 ? 1 / 4000. : 0;
    }
  }
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(double(of_network.clipped[c]) / double(of_network.pairs), below[c], 0.05);
}

TEST(Fits, MeasuredTablesAgreeWithTheReference) {
  if (measured_data().empty()) GTEST_SKIP() << "REFLECTREE_DATA is not set";
  for (const char* m : {"alum-bronze", "chrome", "pink-fabric"})
    expect_close(measured_data() + "/nbrdf/nbrdf_merl.csv", m);
  for (const char* m : {"alum-bronze", "chrome", "green-acrylic", "tungsten-carbide", "white-paint"}) {
    expect_close(measured_data() + "/fits/sgd_merl100.csv", m);
  }
  for (const char* m : {"alum-bronze", "chrome", "white-fabric"})
    expect_close(measured_data() + "/fits/abc_merl100.csv", m);
}

TEST(Fits, EveryMeasuredMaterialIsFiniteAndNotNegative) {
  if (measured_data().empty()) GTEST_SKIP() << "REFLECTREE_DATA is not set";
  Pairs pairs = random_pairs(400, 0.3f, 5);
  for (const float z : {1.f, 1e-3f, 1.7e-5f, 1e-7f}) {  // 89.999 degrees and beyond
    for (const float phi : {0.f, 1.f, pi}) {
      pairs.wo.push_back({sqrt(1 - z * z), 0, z});
      pairs.wi.push_back({0.8f * cos(phi), 0.8f * sin(phi), 0.6f});
      pairs.wo.push_back(pairs.wi.back());
      pairs.wi.push_back({sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z});
      pairs.wo.push_back({sqrt(1 - z * z), 0, z});
      pairs.wi.push_back({sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z});
    }
  }
  std::vector<float> values(pairs.wo.size() * 3);
  int materials = 0;
  for (const char* file : {"/nbrdf/nbrdf_merl.csv", "/nbrdf/nbrdf_rgl-isotropic.csv", "/fits/sgd_merl100.csv",
                           "/fits/abc_merl100.csv"}) {
    for (const std::string& member : list_members(measured_data() + file)) {
      const AnyBrdf f = load_brdf(measured_data() + file, member);
      f.eval(pairs.wo, pairs.wi, values);
      ++materials;
      for (const float v : values) ASSERT_TRUE(v >= 0 && std::isfinite(v)) << f.traits().name;
    }
  }
  EXPECT_EQ(materials, 60 + 26 + 60 + 60);
}

std::string error_of(const std::string& text, const std::string& member = "") {
  return error_words([&] { read_brdf(synthetic::as_bytes(text), "t.csv", member); });
}

TEST(ParameterTable, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(error_of(synthetic::neural_csv(), "on"), "t.csv: no material 'on'; the nearest of 2: one, two");
  EXPECT_NE(error_of(synthetic::neural_csv()).find("holds 2 materials; name one as FILE#MATERIAL"),
            std::string::npos);
  EXPECT_EQ(error_of(synthetic::sgd_csv()), "no error");  // a single material needs no name
  EXPECT_NE(error_of("material,\n").find("no material"), std::string::npos);
  EXPECT_NE(error_of("material,a,b\nx,1,2\n").find("fit no model"), std::string::npos);
  const Bytes foreign = synthetic::as_bytes("material,a,b\nx,1,2\n");  // and no member of it is listed
  EXPECT_NE(
      error_words([&] { format_of(foreign, "t.csv").list_members(foreign, "t.csv"); }).find("fit no model"),
      std::string::npos);
  EXPECT_NE(error_of("material,a,b\nx,1\n").find("line 2: "), std::string::npos);
  EXPECT_NE(error_of("material,a,b\nx,1,2,3\n").find("line 2: "), std::string::npos);
  EXPECT_NE(error_of("material,a\n\nx,1e999\n").find("line 3: '1e999' is not a finite number"),
            std::string::npos);
  for (const char* bad : {"nan", "inf", "0x10", "1e", "--1", "", "1,", ".", "1 "}) {
    EXPECT_NE(error_of(std::string("material,a\nx,") + bad + "\n"), "no error") << bad;
  }
  std::string table = synthetic::abc_csv();
  table.replace(table.find("2.2365"), 6, "0.5");
  EXPECT_NE(error_of(table).find("'ior' of 'bronze' is out of range"), std::string::npos);
  table = synthetic::sgd_csv();
  table.replace(table.find("1e49"), 4, "-1e9");
  EXPECT_NE(error_of(table).find("'c_r' of 'varnish' is out of range"), std::string::npos);
  EXPECT_NE(error_of("material,a\nx,1\ny,2\nx,3\n").find("material 'x' stands in two lines"),
            std::string::npos);
  EXPECT_NE(error_of("material,a,b,a\nx,1,2,3\n").find("column 'a' stands twice"), std::string::npos);
}

TEST(ParameterTable, ReadsNumbersToTheLastFloatDigit) {
  const auto read = [](const std::string& number) {
    return read_parameter_table(synthetic::as_bytes("material,a\nx," + number), "t").rows[0].values[0];
  };
  Pcg32 bits(8);
  for (int i = 0; i < 5000; ++i) {
    const double exponent = 200 * to_unit_double(bits()) - 100;
    const double v = (to_unit_double(bits()) - 0.5) * std::pow(10, exponent);
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", v);
    ASSERT_NEAR(read(text), v, 1e-14 * std::abs(v)) << text;
  }
  EXPECT_EQ(read("-0.5"), -0.5);
  EXPECT_EQ(read("+12.25e-1"), 1.225);
  EXPECT_EQ(read("1e-400"), 0);
  EXPECT_NEAR(read("123456789012345678901234567890e-29"), 1.2345678901234567, 1e-14);
}

TEST(MaterialFile, NamesAreCanonicalMaterialText) {
  const Bytes table = synthetic::as_bytes(synthetic::neural_csv());
  EXPECT_EQ(read_brdf(table, "t.csv", "two").traits().name, "t.csv#two");
  EXPECT_EQ(read_brdf(synthetic::rgl_file(), "a b.bsdf").traits().name, "\"a b.bsdf\"");
}

}  // namespace
}  // namespace reflectree
