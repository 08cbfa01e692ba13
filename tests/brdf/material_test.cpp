// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/material/material.hpp"

#include <gtest/gtest.h>

#include <locale>

#include "../error_words.hpp"
#include "random_models.hpp"
#include "reflectree/brdf/material/registry.hpp"
#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree {
namespace {

std::string canonical(std::string_view text) { return to_text(parse_material(text)); }

std::string error_of(std::string_view text) {
  return error_words([&] { parse_material(text); });
}

TEST(Material, PrintsItsCanonicalForm) {
  EXPECT_EQ(canonical("0.3*lambert:rho=0.5 + ggx:alpha=0.1,f0=1/0.8/0.3"),
            "0.3*lambert:rho=0.5 + ggx:alpha=0.1,f0=1/0.8/0.3");
  EXPECT_EQ(canonical(" ggx "), "ggx:alpha=0.1,f0=1/0.8/0.3");
  EXPECT_EQ(canonical("ggx : f0 = .5 / 5e-1 / +0.50 , alpha = 1"), "ggx:alpha=1,f0=0.5");
  EXPECT_EQ(canonical("1*lambert+2.50*lambert:rho=1"), "lambert:rho=0.5 + 2.5*lambert:rho=1");
  EXPECT_EQ(canonical("phong:kd=-0,n=1e6"), "phong:kd=0,ks=0.6,n=1e+06");
}

TEST(Material, APairIsSetTogether) {
  EXPECT_EQ(canonical("ward:alpha=0.3"), "ward:kd=0.2,ks=0.6,alpha=0.3");
  EXPECT_EQ(canonical("ward:alpha_y=0.3"), "ward:kd=0.2,ks=0.6,alpha_x=0.15,alpha_y=0.3");
  EXPECT_TRUE(make_brdf(parse_material("ward:alpha=0.3")).traits().isotropic);
  EXPECT_FALSE(make_brdf(parse_material("ward:alpha_y=0.3")).traits().isotropic);
}

TEST(Material, ARangeMakesAFamily) {
  const Material m = parse_material("0.3*lambert:rho=0.5 + ggx:alpha = 0.02 .. 1");
  EXPECT_TRUE(is_family(m));
  EXPECT_FALSE(is_family(parse_material("ggx:alpha=0.02")));
  EXPECT_EQ(to_text(m), "0.3*lambert:rho=0.5 + ggx:alpha=0.02..1,f0=1/0.8/0.3");
  EXPECT_EQ(parse_material(to_text(m)), m);
  const AnyFamily family = make_family(m);
  EXPECT_EQ(family.ranges(), (std::vector<ParameterRange>{{"alpha", 0.02f, 1}}));
  EXPECT_EQ(family.traits().name, to_text(m));
  EXPECT_EQ(to_text(member_of(m, {0.3f})), "0.3*lambert:rho=0.5 + ggx:alpha=0.3,f0=1/0.8/0.3");
  const AnyBrdf member = make_brdf(member_of(m, {0.3f}));
  const ShadingGeometry<float> g =
      shading_geometry(direction_from_angles(0.5f, 0.2f), direction_from_angles(0.6f, 3.f));
  const Spectrum a = family(g, {0.3f}), b = member(g), c = family.member({0.3f})(g), d = family(g, {0.31f});
  for (int k = 0; k < 3; ++k) {
    EXPECT_FLOAT_EQ(a[k], b[k]);
    EXPECT_FLOAT_EQ(a[k], c[k]);
    EXPECT_NE(a[k], d[k]);
  }
}

TEST(Material, TwoRangesVaryApartOrTogether) {
  for (const char* text : {"ggx:alpha_x=0.05..1,alpha_y=0.05..1,f0=1", "ggx:alpha=0.05..1,f0=1",
                           "ggx:alpha_x=0.05..1,alpha_y=0.05,f0=1", "phong:kd=0.2,ks=0.6,n=1..1000",
                           "ward:kd=0.2,ks=0.6,alpha=0.1,phi_deg=0..90",
                           "lambert:rho=0.5 + ggx:alpha=0.1..1,f0=1 + phong:kd=0,ks=0.1,n=1..90"}) {
    const Material m = parse_material(text);
    EXPECT_EQ(to_text(m), text);
    EXPECT_EQ(parse_material(to_text(m)), m);
  }
  const AnyFamily family = make_family(parse_material("ggx:alpha_x=0.05..1,alpha_y=0.1..0.5,f0=1"));
  EXPECT_EQ(family.ranges(), (std::vector<ParameterRange>{{"alpha_x", 0.05f, 1}, {"alpha_y", 0.1f, 0.5f}}));
  const ShadingGeometry<float> g =
      shading_geometry(direction_from_angles(0.5f, 0.2f), direction_from_angles(0.6f, 3.f));
  EXPECT_FLOAT_EQ(family(g, {0.3f, 0.2f})[0],
                  make_brdf(parse_material("ggx:alpha_x=0.3,alpha_y=0.2,f0=1"))(g)[0]);
  EXPECT_EQ(family.traits({0.3f, 0.2f}).name, "ggx:alpha_x=0.3,alpha_y=0.2,f0=1");
}

TEST(Material, ErrorsOfRangesSayWhatWhereAndHow) {
  const auto words = [](const char* text) -> std::string {
    try {
      const Material m = parse_material(text);
      if (is_family(m)) make_family(m);
      return "";
    } catch (const Error& e) {
      return e.what();
    }
  };
  for (const auto& [text, part] : std::vector<std::pair<const char*, const char*>>{
           {"ggx:alpha=1..0.02",
            "column 11: the range of alpha is from 1 to 0.02; give the smaller number first"},
           {"ggx:alpha=0.1..0.1", "smaller number first"},
           {"ggx:alpha=0.02..2", "out of range"},
           {"ggx:alpha=0..1", "out of range"},
           {"ggx:alpha=0.1..", "expected a number"},
           {"ggx:alpha=..1", "expected a number"},
           {"ggx:alpha=0.1..0.2..0.3", "unexpected"},
           {"ggx:f0=0.1..0.2", "colour"},
           {"ggx:f0=0.1/0.2/0.3..1", "colour"},
           {"ggx:alpha=0.1/0.2/0.3..1", "one number"},
           {"ggx:alpha=0.1..0.2 + plastic:alpha=0.1..0.2", "both named alpha"},
           {"ggx:alpha_x=0.1..0.2,alpha_y=0.1..0.2 + phong:n=1..2", "more than two ranges"},
           {"ggx:alpha=0.1..0.2,alpha_x=0.1", "given twice"},
           {"lambert:sigma=0..1", "unknown parameter"}}) {
    EXPECT_NE(words(text).find(part), std::string::npos) << text << ": " << words(text);
  }
  EXPECT_THROW(make_brdf(parse_material("ggx:alpha=0.1..0.2")), Error);
  EXPECT_THROW(make_family(parse_material("ggx:alpha=0.1")), Error);
  EXPECT_THROW(member_of(parse_material("ggx:alpha=0.1..0.2"), {0.3f}), Error);
}

TEST(Material, AWordWithAMarkIsAFile) {
  const Material m =
      parse_material("0.5*dir/a-b.bsdf + ./x#chm_mint + \"a b+c\\\"\\\\\"#\"m 1\" + lambert#m");
  ASSERT_EQ(m.terms.size(), 4U);
  EXPECT_EQ(m.terms[0].path, "dir/a-b.bsdf");
  EXPECT_EQ(m.terms[0].weight, 0.5f);
  EXPECT_EQ(m.terms[1].path, "./x");
  EXPECT_EQ(m.terms[1].member, "chm_mint");
  EXPECT_EQ(m.terms[2].path, "a b+c\"\\");
  EXPECT_EQ(m.terms[2].member, "m 1");
  EXPECT_EQ(m.terms[3].path, "lambert");
  EXPECT_EQ(parse_material(to_text(m)), m);
}

TEST(Material, ABareExistingPathIsAFileWhateverItContains) {
  const FileExists exists = [](const std::string& path) {
    return path == "my + file" || path == "0.3*x#y" || path == "mat";
  };
  EXPECT_EQ(parse_material("my + file", exists).terms.at(0).path, "my + file");
  EXPECT_EQ(parse_material("my + file#gold", exists).terms.at(0).member, "gold");
  EXPECT_EQ(parse_material("0.3*x#y", exists).terms.at(0).path, "0.3*x#y");
  EXPECT_EQ(parse_material("0.5*mat + lambert", exists).terms.at(0).path, "mat");
  EXPECT_THROW(parse_material("my + file"), Error);
  for (const char* text : {"my + file", "my + file#gold", "0.3*x#y", "0.5*mat + lambert"}) {
    const Material m = parse_material(text, exists);
    EXPECT_EQ(parse_material(to_text(m)), m) << text;
  }
}

TEST(Material, EveryModelIsListedWithADefaultThatPrintsAndParses) {
  for (const ModelInfo& model : models()) {
    const Material m = parse_material(model.name);
    EXPECT_EQ(parse_material(to_text(m)), m);
    EXPECT_EQ(make_brdf(m).traits().name, to_text(m));
    EXPECT_FALSE(model.summary.empty() || model.source.empty());
    EXPECT_EQ(&nearest_model(std::string(model.name) + "x"), &model);
  }
}

// NAME_x, NAME_y of any model can be given, and are printed, together.
TEST(Material, APairOfAnyModelIsGivenByOneName) {
  int pairs = 0;
  for (const ModelInfo& model : models()) {
    for (std::size_t i = 0; i < model.parameters.size(); ++i) {
      std::string pair(model.parameters[i].name);
      if (!pair.ends_with("_x")) continue;
      ++pairs;
      pair.back() = 'y';
      ASSERT_LT(i + 1, model.parameters.size()) << model.name;
      ASSERT_EQ(model.parameters[i + 1].name, pair) << model.name;
      const std::string both = pair.substr(0, pair.size() - 2) + "=" + shortest_text(model.parameters[i].hi);
      const std::string text = std::string(model.name) + ":" + both;
      const Material m = parse_material(text);
      EXPECT_EQ(m.terms[0].values[i], m.terms[0].values[i + 1]) << text;
      EXPECT_NE(to_text(m).find(both), std::string::npos) << to_text(m);
    }
  }
  EXPECT_GE(pairs, 2);
}

template <class M>
void expect_model_survives_text(Pcg32& bits) {
  const M model = random_model<M>(bits);
  const std::string text = model.traits().name;
  const Material m = parse_material(text);
  EXPECT_EQ(to_text(m), text);
  const AnyBrdf any = make_brdf(m);
  EXPECT_EQ(any.traits().name, text);
  const ShadingGeometry<float> g = shading_geometry(random_direction(bits), random_direction(bits));
  EXPECT_EQ(to_rgb(any(g)), eval(model, g)) << text;
}

TEST(Material, RandomModelsSurviveText) {
  Pcg32 bits(1);
  for (int i = 0; i < 50; ++i) {
    for_each_model([&bits]<class M>(std::type_identity<M>) { expect_model_survives_text<M>(bits); });
  }
}

// Random words of the grammar, glued at random: whatever parses must be stable; most of it does not.
TEST(Material, WhateverParsesIsStable) {
  const char* words[] = {"lambert", "ggx",  "ward",      ":",       ",",         "=",          "+",
                         "*",       "#",    "/",         "\"",      "\\",        " ",          "0.3",
                         "1",       "2e-1", "alpha=0.2", "rho=0.5", "f0=1/.5/0", "alpha_x=.5", "a/b",
                         "x.bsdf",  "m",    "-",         "\xc3\xb6"};
  Pcg32 bits(2);
  int parsed = 0;
  for (int i = 0; i < 200'000; ++i) {
    std::string text;
    const int count = 1 + int(bits() % 8);
    for (int w = 0; w < count; ++w) text += words[bits() % std::size(words)];
    try {
      const Material m = parse_material(text);
      ++parsed;
      const std::string printed = to_text(m);
      ASSERT_EQ(parse_material(printed), m) << text;
      ASSERT_EQ(canonical(printed), printed) << text;
    } catch (const Error&) {
    }
  }
  EXPECT_GT(parsed, 5000);
}

TEST(Material, ErrorsSayWhatWhereAndHow) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "column 1: expected a model or a file, found end"},
      {"lamber", "column 1: unknown model 'lamber'; did you mean 'lambert'?"},
      {"0.3*lamber", "column 5: unknown model"},
      {"ggx:beta=1", "column 5: unknown parameter 'beta'; ggx has alpha_x, alpha_y, f0, phi_deg"},
      {"ggx:", "column 5: expected a parameter, found end; ggx has alpha_x, alpha_y, f0, phi_deg"},
      {"ggx:alpha", "column 10: missing value of alpha"},
      {"ggx:alpha=", "column 11: expected a number, found end"},
      {"ggx:alpha=nan", "column 11: expected a number, found 'nan'"},
      {"ggx:alpha=inf", "column 11: expected a number, found 'inf'"},
      {"ggx:alpha=1e99", "column 11: alpha is out of range; alpha must lie between 0.001 and 1"},
      {"ggx:alpha=2", "column 11: alpha is out of range"},
      {"oren_nayar:sigma=2", "sigma must lie between 0 and 1.5707964 rad"},
      {"ggx:f0=1/2/0", "column 8: f0 is out of range"},
      {"ggx:f0=1/1", "column 11: expected '/', found end; give one number, or three"},
      {"ggx:alpha=1/1/1", "alpha takes one number"},
      {"ggx:alpha=1,alpha=1", "column 13: parameter 'alpha' is given twice"},
      {"ward:alpha=2", "column 12: alpha is out of range; alpha must lie between 0.001 and 1"},
      {"ward:alpha=1/1/1", "alpha takes one number"},
      {"ward:alpha=1,alpha_y=1", "column 14: parameter 'alpha_y' is given twice"},
      {"ggx lambert", "column 5: unexpected 'lambert'; join terms with '+'"},
      {"ggx +", "column 6: expected a model or a file, found end"},
      {"ggx:alpha=0.1.2", "column 14: unexpected '.2'"},
      {"0*ggx", "column 1: weight out of range"},
      {"-1*ggx", "column 1: weight out of range"},
      {"1e9*ggx", "column 1: weight out of range"},
      {"0.3", "column 1: a number without a model; write WEIGHT*MODEL"},
      {"phong:kd=0.7,ks=0.5", "column 1: parameters of phong do not fit together; kd + ks must not exceed 1"},
      {"x.bsdf:a=1", "a file takes no parameters"},
      {"x.bsdf#", "missing member after '#'"},
      {"\"x", "without its closing one"},
      {"\"\"", "an empty path"},
      {"ggx\n", "column 4: contains a control character"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_NE(error_of(text).find(message), std::string::npos) << text << " gave: " << error_of(text);
  }
  std::string many = "ggx";
  for (int i = 0; i < 16; ++i) many += "+ggx";
  EXPECT_NE(error_of(many).find("too many terms; use at most 16"), std::string::npos);
  EXPECT_NE(error_of(std::string(5000, ' ')).find("longer than 4096 bytes"), std::string::npos);
}

TEST(Material, MakesSumsAndLoadsFiles) {
  const FileLoader load = [](const std::string& path, const std::string& member) -> AnyBrdf {
    EXPECT_EQ(path + "|" + member, "a.bsdf|gold");
    return Lambert{{1, 1, 1}};
  };
  const AnyBrdf any = make_brdf(parse_material("0.5*a.bsdf#gold + lambert:rho=0.5"), load);
  EXPECT_EQ(any.traits().name, "0.5*a.bsdf#gold + lambert:rho=0.5");
  const Direction w{0, 0, 1};
  EXPECT_FLOAT_EQ(any(shading_geometry(w, w))[0], 1 / pi);
  EXPECT_EQ(make_brdf(parse_material("a.bsdf#gold"), load).traits().name, "a.bsdf#gold");
  EXPECT_THROW(make_brdf(parse_material("a.bsdf")), Error);
  EXPECT_THROW(make_brdf(Material{}), Error);
  EXPECT_THROW(make_brdf({{{1, "ggx", {{7, 7, 7}, {1, 1, 1}}, "", ""}}}), Error);
  EXPECT_THROW(make_brdf({{{1, "ggx", {}, "", ""}}}), Error);
  EXPECT_THROW(make_brdf({{{1, "no_model", {}, "", ""}}}), Error);
}

TEST(NumberText, DoesNotAskTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const std::string text = canonical("0.5*phong:n=1234.5");
  std::locale::global(before);
  EXPECT_EQ(text, "0.5*phong:kd=0.2,ks=0.6,n=1234.5");
}

}  // namespace
}  // namespace reflectree
