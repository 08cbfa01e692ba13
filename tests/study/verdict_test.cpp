// SPDX-License-Identifier: Apache-2.0
// The verdict on results made up: it can say yes and no, and lists a loss with its cause.
#include "reflectree/study/verdict.hpp"

#include <gtest/gtest.h>

#include "reflectree/study/report.hpp"

namespace reflectree::study {
namespace {

SamplerResult result(const char* name, double error, double ns) {
  SamplerResult r;
  r.sampler = name;
  StudyCell cell;
  cell.error = {error}, cell.sample_ns = ns, cell.floor_ns = 10;
  r.cells = {cell};
  return r;
}

const SamplerInfo list[] = {{"exact", "", "Reflectree", true, true, nullptr},
                            {"one-shot", "", "Reflectree", true, true, nullptr},
                            {"other", "", "a paper", true, true, nullptr},
                            {"special", "", "a paper", false, true, nullptr}};

struct VerdictOf : testing::Test {
  std::vector<Illumination> lights{{"sky", {}, 1, 1, {}}};
  StudyOptions options;
  VerdictOf() { options.theta_o_deg = {45}; }
  Verdict of(std::vector<MaterialResult> m) const { return judge(m, list, lights, options); }
};

// Nine materials where the better mode wins by 2, one that is lost by `loss`.
std::vector<MaterialResult> ten(double loss) {
  std::vector<MaterialResult> all;
  for (int i = 0; i < 10; ++i) {
    const double other = i == 9 ? 1 / loss : 2;
    all.push_back({"m" + std::to_string(i),
                   {1},
                   {0},
                   {},
                   {result("exact", 1, 30), result("one-shot", 1, 20), result("other", other, 20),
                    result("special", 0.01, 20)}});
  }
  return all;
}

TEST_F(VerdictOf, HoldsWithOneLossInTen) {
  const Verdict v = of(ten(3));
  EXPECT_TRUE(v.nine_in_ten && v.best_in_mean);
  EXPECT_EQ(v.won, 9);
  ASSERT_EQ(v.losses.size(), 1U);
  EXPECT_EQ(v.losses[0].material, "m9");
  EXPECT_EQ(v.losses[0].winner, "other");
  EXPECT_NEAR(v.losses[0].ratio, 1. / 3, 1e-9);
  EXPECT_NEAR(v.losses[0].error_ratio, 1. / 3, 1e-9);
  EXPECT_NEAR(v.losses[0].time_ratio, 1, 1e-9);
  EXPECT_EQ(cause_of(v.losses[0]), "samples that vary less");
  EXPECT_NEAR(v.scores[0].relative_efficiency, 2. / 3, 1e-9);
}

TEST_F(VerdictOf, FailsInTheMean) { EXPECT_FALSE(of(ten(1e6)).best_in_mean); }

TEST_F(VerdictOf, FailsWithTwoLossesInTen) {
  std::vector<MaterialResult> all = ten(3);
  all[8].samplers[2].cells[0].error[0] = 0.5;
  EXPECT_FALSE(of(all).nine_in_ten);
}

// Letters that mean something in a drawing's labels do not in names; a loss leads to its material.
TEST_F(VerdictOf, ThePageNamesItsMaterials) {
  std::vector<MaterialResult> all = ten(3);
  all[9].material = "rgl/chm_mint_rgb.bsdf";
  const std::string page = study_html(all, of(all), lights, options, {"reflectree compare", "0", "m", "c"});
  EXPECT_NE(page.find(">chm_mint<"), std::string::npos);
  EXPECT_EQ(page.find("chm<tspan"), std::string::npos);
  EXPECT_NE(page.find("<a href=\"#material-10\">chm_mint</a>"), std::string::npos);
  EXPECT_NE(page.find("id=\"material-10\""), std::string::npos);
}

// Equal densities share a line of the key; curves keep no more points than they need.
TEST_F(VerdictOf, SlicesAreDrawnWithFewPoints) {
  MaterialResult m;
  const auto angles = plane_angles(45);
  std::vector<double> lobe;
  for (const double a : angles) lobe.push_back(std::exp(-a * a / 800));
  m.slices = {lobe};
  SamplerResult same{"exact", "", 0, 0, {}, {}, {lobe}}, also{"one-shot", "", 0, 0, {}, {}, {lobe}};
  SamplerResult broken{"other", "", 0, 0, {}, {}, {lobe}};
  for (std::size_t i = 0; i < lobe.size(); ++i) {
    if (angles[i] > 30) broken.slices[0][i] = 0;
  }
  m.samplers = {same, also, broken};
  const draw::Figure f = slice_figure(m, options);
  EXPECT_NE(f.body.find("exact, one-shot"), std::string::npos);
  EXPECT_LT(f.body.size(), 8000U);
  m.samplers = {same, broken, also};
  EXPECT_EQ(slice_figure(m, options).body.find("other, "), std::string::npos);
}

TEST_F(VerdictOf, ThePageIsWholeAndOffline) {
  std::vector<MaterialResult> all = ten(3);
  all[0].material = "<script>";
  const std::string page = study_html(all, of(all), lights, options, {"reflectree compare", "0", "m", "c"});
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_NE(page.find("m9"), std::string::npos);
  EXPECT_NE(page.find("</html>"), std::string::npos);
}

}  // namespace
}  // namespace reflectree::study
