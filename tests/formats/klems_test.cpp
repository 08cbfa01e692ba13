// SPDX-License-Identifier: Apache-2.0
// Klems matrices in WINDOW/Radiance XML: where patches lie, rows and columns, members, the XML that is read,
// errors with their lines, and an independent reading of synthetic and measured files.
#include <gtest/gtest.h>

#include "../error_words.hpp"
#include "measured_data.hpp"
#include "reference_values.hpp"
#include "reflectree/brdf/tables/klems_table.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/measured_facts.hpp"
#include "synthetic.hpp"

namespace reflectree {
namespace {

using synthetic::as_bytes;
using synthetic::klems_file;
using synthetic::klems_xml;
using synthetic::KlemsRecipe;

using Names = std::vector<std::string>;

float value(const AnyBrdf& f, Direction wo, Direction wi) { return f(shading_geometry(wo, wi))[0]; }

Direction direction(double theta_deg, double phi_deg) {
  const auto w = direction_from_angles(theta_deg * pi_v<double> / 180, phi_deg * pi_v<double> / 180);
  return {float(w.x), float(w.y), float(w.z)};
}

Names members_of(const KlemsRecipe& recipe) {
  const TemporaryFolder folder("klems");
  write_file_atomically(folder / "m.xml", klems_file(recipe));
  return list_members(folder / "m.xml");
}

TEST(Klems, PatchesAreCentredAndCountedCounterClockwise) {
  const double degree = pi_v<double> / 180;
  const KlemsBasis basis({0, 20 * degree, 60 * degree, 90 * degree}, {1, 4, 6});
  EXPECT_EQ(basis.size(), 11);
  for (const double phi : {0.0, 100.0, -100.0, 180.0, -180.0})
    EXPECT_EQ(basis.patch_of(direction(19, phi)), 0);
  EXPECT_EQ(basis.patch_of({0, 0, 1}), 0);
  EXPECT_EQ(basis.patch_of({0, 0, 1.0000001f}), 0);
  for (const double theta : {21.0, 59.0}) {
    EXPECT_EQ(basis.patch_of(direction(theta, 44)), 1);
    EXPECT_EQ(basis.patch_of(direction(theta, -44)), 1);
    EXPECT_EQ(basis.patch_of(direction(theta, 46)), 2);
    EXPECT_EQ(basis.patch_of(direction(theta, 134)), 2);
    EXPECT_EQ(basis.patch_of(direction(theta, 136)), 3);
    EXPECT_EQ(basis.patch_of(direction(theta, -136)), 3);
    EXPECT_EQ(basis.patch_of(direction(theta, -90)), 4);
  }
  for (const double theta : {61.0, 89.9999}) {
    EXPECT_EQ(basis.patch_of(direction(theta, 29)), 5);
    EXPECT_EQ(basis.patch_of(direction(theta, 31)), 6);
    EXPECT_EQ(basis.patch_of(direction(theta, -31)), 10);
    EXPECT_EQ(basis.patch_of(direction(theta, 180)), 8);
  }
  double sum = 0;
  for (int i = 0; i < basis.size(); ++i) sum += basis.projected_solid_angle(i);
  EXPECT_NEAR(sum, pi_v<double>, 1e-6);
  EXPECT_NEAR(basis.projected_solid_angle(2), pi_v<double> / 4 * (sqr(std::cos(20 * degree)) - 0.25), 1e-6);
  EXPECT_EQ(KlemsBasis({0, 0.5}, {1}).patch_of(direction(40, 0)), -1);
  EXPECT_GE(basis.patch_of({std::nanf(""), 0, 0.5f}), 0);
}

// f tells the patches: in + out / 100.
KlemsRecipe telling() {
  KlemsRecipe recipe;
  recipe.value = [](int, bool, int in, int out) { return in + 0.01 * out; };
  return recipe;
}

TEST(Klems, LightThatGoesStraightOnKeepsItsNumber) {
  const AnyBrdf back = read_brdf(klems_file(telling()), "m.xml", "back");
  // wo at azimuth 180 is incident patch 1 of the middle ring, 5 of the outer one.
  EXPECT_NEAR(value(back, direction(40, 180), direction(70, 0)), 1.05, 1e-5);
  EXPECT_NEAR(value(back, direction(70, 180), direction(40, 90)), 5.02, 1e-5);
  EXPECT_NEAR(value(back, direction(40, 90), direction(70, 60)), 4.06, 1e-5);
  EXPECT_NEAR(value(back, direction(0, 0), direction(70, -60)), 0.10, 1e-5);
  // Seen from the other side x points the other way.
  const AnyBrdf front = read_brdf(klems_file(telling()), "m.xml", "front");
  EXPECT_NEAR(value(front, direction(40, 0), direction(70, 180)), 1.05, 1e-5);
  EXPECT_NEAR(value(front, direction(40, 90), direction(70, 60)), 4.07, 1e-5);
  EXPECT_NEAR(value(front, direction(70, 60), direction(40, 90)), 10.02, 1e-5);
  EXPECT_EQ(front.channels(), 1);
  EXPECT_FALSE(front.traits().isotropic);
  EXPECT_EQ(front.traits().theta_o_knots.size(), 2U);
}

TEST(Klems, RowsAreColumnsTransposed) {
  KlemsRecipe rows = telling();
  rows.structure = "Rows";
  const AnyBrdf a = read_brdf(klems_file(telling()), "m.xml"), b = read_brdf(klems_file(rows), "m.xml");
  const Pairs pairs = random_pairs(500, 0.5f, 2);
  for (std::size_t i = 0; i < pairs.wo.size(); ++i)
    EXPECT_EQ(value(a, pairs.wo[i], pairs.wi[i]), value(b, pairs.wo[i], pairs.wi[i]));
}

TEST(Klems, FrontComesFirstAndVisibleLightToo) {
  KlemsRecipe recipe;
  EXPECT_EQ(members_of(recipe), (Names{"front", "back"}));
  recipe.wavelengths = {"Solar", "Visible", "CIE-X"};
  EXPECT_EQ(members_of(recipe),
            (Names{"front", "back", "solar-front", "solar-back", "cie-x-front", "cie-x-back"}));
  const Bytes bytes = klems_file(recipe);
  const Direction up{0, 0, 1};
  EXPECT_NEAR(value(read_brdf(bytes, "m.xml"), up, up), 0.11, 1e-6);
  EXPECT_NEAR(value(read_brdf(bytes, "m.xml", "back"), up, up), 0.21, 1e-6);
  EXPECT_NEAR(value(read_brdf(bytes, "m.xml", "solar-front"), up, up), 0.1, 1e-6);
  EXPECT_EQ(read_brdf(bytes, "m.xml", "cie-x-back").traits().name, "m.xml#cie-x-back");
  recipe.wavelengths = {"0.55 microns"}, recipe.directions = {"Reflection Back"};
  EXPECT_EQ(members_of(recipe), Names{"back"});
  EXPECT_NEAR(value(read_brdf(klems_file(recipe), "m.xml"), up, up), 0.2, 1e-6);
  EXPECT_EQ(read_brdf(klems_file(recipe), "m.xml").traits().name, "m.xml");
}

TEST(Klems, BasesThatAreOnlyNamed) {
  KlemsRecipe recipe = telling();
  recipe.defined = false;
  const auto ring_of = [&](const char* basis, std::vector<int> patches, double theta) {
    recipe.basis = basis, recipe.patches = std::move(patches);
    const AnyBrdf f = read_brdf(klems_file(recipe), "m.xml", "back");
    return int(std::lround(value(f, direction(theta, 180), {0, 0, 1})));
  };
  EXPECT_EQ(ring_of("LBNL/Klems Full", {1, 8, 16, 20, 24, 24, 24, 16, 12}, 74), 117);
  EXPECT_EQ(ring_of("LBNL/Klems Half", {1, 8, 12, 16, 20, 12, 8}, 74), 69) << "71.5 begins the last ring";
  EXPECT_EQ(ring_of("lbnl/klems half", {1, 8, 12, 16, 20, 12, 4}, 74), 57) << "76.5 did once";
  EXPECT_EQ(ring_of("LBNL/Klems Quarter", {1, 8, 12, 12, 8}, 64), 33);
  recipe.basis = "LBNL/Klems Eighth";
  EXPECT_THROW(read_brdf(klems_file(recipe), "m.xml"), Error);
}

TEST(Klems, FactsTellTheMatrix) {
  KlemsRecipe recipe;
  recipe.value = [](int, bool, int in, int out) { return in == 0 && out < 3 ? -0.5 : 1 / pi_v<double>; };
  const MeasuredFacts facts = *measured_facts(klems_file(recipe), "m.xml");
  EXPECT_EQ(facts.kind, "Klems matrix of 11 incident and 11 exiting patches, Visible, reflection front");
  EXPECT_EQ(facts.entries, 121U);
  EXPECT_EQ(facts.negative, 3U);
  ASSERT_EQ(facts.notes.size(), 3U);
  EXPECT_EQ(facts.notes[2], "reflects at most 1 of the light of a patch");
  EXPECT_EQ(value(read_brdf(klems_file(recipe), "m.xml"), {0, 0, 1}, {0, 0, 1}), 0);
  EXPECT_EQ(measured_facts(klems_file(recipe), "m.xml", "back")->notes.size(), 2U);
}

std::string error_of(const std::string& text, const std::string& member = "") {
  return error_words([&] { read_brdf(as_bytes(text), "m.xml", member); });
}

// The file with one text replaced by another, once.
std::string with(const std::string& from, const std::string& to) {
  std::string text = klems_xml({});
  const std::size_t at = text.find(from);
  if (at == text.npos) throw std::runtime_error("the file has no " + from);
  return text.replace(at, from.size(), to);
}

TEST(Klems, ErrorsNameTheLine) {
  const std::string mend = "; mend the line or fetch the file again";
  EXPECT_EQ(error_of(klems_xml({})), "no error");
  for (const char* tree : {"TensorTree3", "TensorTree4"}) {
    EXPECT_EQ(error_of(with("Columns", tree)),
              "m.xml: a tensor tree: only Klems matrices are read; name a file of matrices");
  }
  EXPECT_EQ(error_of(with("Columns", "Diagonals")), "m.xml: line 7: neither Columns nor Rows" + mend);
  EXPECT_EQ(error_of(with("<DataDefinition>", "<Data>")),
            "m.xml: line 13: </DataDefinition> closes 'Data'" + mend);
  EXPECT_EQ(error_of(with("<nPhis>4", "<nPhis>4.5")), "m.xml: line 10: not a count of patches" + mend);
  EXPECT_EQ(error_of(with("<nPhis>4", "<nPhis>four")),
            "m.xml: line 10: <nPhis> is not a finite number" + mend);
  EXPECT_EQ(error_of(with("<LowerTheta>20", "<LowerTheta>21")),
            "m.xml: line 10: a ring that does not begin where the last one ends" + mend);
  EXPECT_EQ(error_of(with("<UpperTheta>60", "<UpperTheta>15")),
            "m.xml: line 10: a ring that does not end above its beginning, by 90" + mend);
  EXPECT_EQ(error_of(with("<nPhis>4", "<nPhis>5")), "m.xml: line 44: 121 numbers for 12 x 12 patches" + mend);
  EXPECT_EQ(error_of(with("0.100000", "0.1x")), "no error") << "transmission is not looked at";
  EXPECT_EQ(error_of(with("0.200000", "0.2x"), "back"),
            "m.xml: line 30 or after: '0.2x' is not a plausible number" + mend);
  EXPECT_EQ(error_of(klems_xml({}), "left"), "m.xml: no member 'left'; its members: #front, #back");
  KlemsRecipe recipe;
  recipe.directions = {"Transmission Front"};
  EXPECT_EQ(error_of(klems_xml(recipe)),
            "m.xml: no reflection in the file; name a file with a block Reflection Front or Back");
  recipe.directions = {"Reflection Back", "Reflection Back"};
  EXPECT_EQ(error_of(klems_xml(recipe)), "m.xml: line 29: a second block that is called back" + mend);
}

TEST(Klems, TheXmlIsStrictAndExpandsNothing) {
  const std::string mend = "; mend the line or fetch the file again";
  const std::string head = "<WindowElement/>\n";
  EXPECT_EQ(error_of("<WindowElement"), "m.xml: line 1: the file ends inside a tag" + mend);
  EXPECT_EQ(error_of("<WindowElement>\n\n<a>"), "m.xml: line 3: the file ends inside 'a'" + mend);
  EXPECT_EQ(error_of(head + "x"), "m.xml: line 1: text outside of the only element" + mend);
  EXPECT_EQ(error_of(head + "<a/>"), "m.xml: line 2: a second element beside the first" + mend);
  EXPECT_EQ(error_of(head + "</a>"), "m.xml: line 2: </a> closes nothing" + mend);
  EXPECT_EQ(error_of("<!DOCTYPE x [<!ENTITY a \"aaaa\">]>\n<WindowElement/>"),
            "m.xml: line 1: a document type or another declaration: not read" + mend);
  EXPECT_EQ(error_of("<WindowElement a=b/>"), "m.xml: line 1: a value that is not quoted" + mend);
  EXPECT_EQ(error_of("<WindowElement a/>"), "m.xml: line 1: an attribute without a value" + mend);
  EXPECT_EQ(error_of("<WindowElement a='b/>"), "m.xml: line 1: the file ends inside a value" + mend);
  EXPECT_EQ(error_of("<WindowElement><!-- x"), "m.xml: line 1: the file ends inside a comment" + mend);
  EXPECT_EQ(error_of("<WindowElement / >"), "m.xml: line 1: a tag that does not end" + mend);
  EXPECT_EQ(error_of("<WindowElement><>"), "m.xml: line 1: no name where one should stand" + mend);
  std::string deep = "<WindowElement>", wide = "<WindowElement>";
  for (int i = 0; i < 100; ++i) deep += "<a>";
  for (int i = 0; i < 100000; ++i) wide += "<a/>";
  EXPECT_EQ(error_of(deep), "m.xml: line 1: elements nested too deeply" + mend);
  EXPECT_EQ(error_of(wide), "m.xml: line 1: more elements than are read" + mend);
  EXPECT_EQ(error_of(head), "m.xml: line 1: <WindowElement> without <Optical>" + mend);
  std::string hidden = klems_xml({});
  const std::string::size_type at = hidden.find("<ScatteringData>\n", hidden.find("Reflection Front"));
  hidden.insert(at + 17, "0.1 <!-- in between --> ");
  EXPECT_EQ(error_of(hidden), "m.xml: line 44: <ScatteringData> in pieces" + mend);
  std::string data = klems_xml({});
  data.replace(data.find("<Name>"), 6, "<Name><![CDATA[<none>]]>");
  EXPECT_EQ(error_of(data), "no error");
}

// The share of pairs whose values differ by more than a rounding: those within a rounding of a border.
double share_that_differs(const AnyBrdf& f, const Pairs& pairs, const std::vector<double>& reference) {
  int differ = 0;
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const double wanted = std::max(reference[i], 0.0);
    differ += std::abs(double(value(f, pairs.wo[i], pairs.wi[i])) - wanted) > 1e-6 * wanted ? 1 : 0;
  }
  return double(differ) / double(pairs.wo.size());
}

TEST(Klems, SyntheticFilesAgreeWithAnIndependentReading) {
  const TemporaryFolder folder("klems");
  const Pairs pairs = random_pairs(5000, 0.5f, 6);
  for (const char* structure : {"Columns", "Rows"}) {
    KlemsRecipe recipe = telling();
    recipe.structure = structure;
    write_file_atomically(folder / "m.xml", klems_file(recipe));
    for (const char* side : {"front", "back"}) {
      const auto reference =
          reference_values("klems_reference.py", {folder / "m.xml", "Visible", side}, pairs);
      EXPECT_LT(share_that_differs(load_brdf(folder / "m.xml", side), pairs, reference), 1e-3);
      const char* other = side[0] == 'f' ? "back" : "front";
      EXPECT_GT(share_that_differs(load_brdf(folder / "m.xml", other), pairs, reference), 0.3)
          << "the other side must show";
    }
  }
}

TEST(Klems, MeasuredFilesAgreeWithAnIndependentReading) {
  if (measured_data().empty()) GTEST_SKIP() << "REFLECTREE_DATA is not set";
  const Pairs pairs = random_pairs(5000, 0.5f, 8);
  int read = 0, trees = 0;
  for (const auto& entry : std::filesystem::directory_iterator(measured_data() + "/radiance_xml")) {
    const std::string file = entry.path().string(), stem = entry.path().stem().string();
    if (stem == "blindsT3" || stem == "t3") {
      EXPECT_THROW(load_brdf(file), Error);
      ++trees;
      continue;
    }
    for (const std::string& member : list_members(file)) {
      const bool solar = member.rfind("solar-", 0) == 0;
      const std::string side = solar ? member.substr(6) : member;
      const auto reference =
          reference_values("klems_reference.py", {file, solar ? "Solar" : "Visible", side}, pairs);
      EXPECT_LT(share_that_differs(load_brdf(file, member), pairs, reference), 1e-3) << file << member;
      ++read;
    }
  }
  EXPECT_EQ(read, 10);
  EXPECT_EQ(trees, 2);
}

// Light may go either way: what tells that in and out, and the half turn between them, are where they should
// be.
TEST(Klems, MeasuredBlindsAreReciprocal) {
  if (measured_data().empty()) GTEST_SKIP() << "REFLECTREE_DATA is not set";
  const AnyBrdf f = load_brdf(measured_data() + "/radiance_xml/blinds30.xml");
  const Pairs pairs = random_pairs(20000, 0.5f, 9);
  double difference = 0, turned = 0, sum = 0;
  const auto half_turn = [](Direction w) { return Direction{-w.x, -w.y, w.z}; };
  for (std::size_t i = 0; i < pairs.wo.size(); ++i) {
    const Direction a = pairs.wo[i], b = pairs.wi[i];
    sum += double(value(f, a, b) + value(f, b, a));
    difference += std::abs(double(value(f, a, b) - value(f, b, a)));
    turned += std::abs(double(value(f, a, half_turn(b)) - value(f, b, half_turn(a))));
  }
  EXPECT_LT(difference / sum, 0.1);
  EXPECT_GT(turned / sum, 0.3) << "a half turn too many must show";
}

}  // namespace
}  // namespace reflectree
