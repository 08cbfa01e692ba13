// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/report.hpp"

#include <gtest/gtest.h>

#include "xml_check.hpp"

namespace reflectree::draw {
namespace {

ReportMaterial sample_material() {
  ReportMaterial m;
  m.name = "<script>alert(1)</script> & \"co\"";
  m.origin = "a > b";
  m.figures.domain = "half_vector";
  m.figures.bounds = "estimated";
  m.figures.exact_leaves = 12345;
  m.figures.kib = 43.21;
  m.figures.mean_trials = 1.1873;
  m.figures.overshoot_mass = 3.1e-8;
  m.figures.chi_square = ChiSquareVerdict{false, 18, 3e-7};
  m.thumbnail = Figure{64, 64, "t", "d", "<g/>"};
  m.views.push_back({45, {Figure{10, 10, "picture", "words", "<g/>"}}});
  m.overview.push_back(Figure{10, 10, "slabs", "words", "<g/>"});
  return m;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

TEST(Report, IsWellFormedAndTheSameEveryTime) {
  const std::vector<ReportMaterial> materials{sample_material(), sample_material()};
  const ReportMeta meta{"T & T", "reflectree draw <x>", "1.0", "today"};
  const std::string page = report_html(materials, meta);
  EXPECT_EQ(xml_fault(page), "");
  EXPECT_EQ(page, report_html(materials, meta));
  EXPECT_EQ(xml_fault(report_html({}, {})), "");
}

TEST(Report, UserTextIsNeverMarkup) {
  const std::string page = report_html({sample_material()}, {});
  EXPECT_FALSE(has(page, "<script"));
  EXPECT_TRUE(has(page, "&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;co&quot;"));
}

TEST(Report, NothingIsFetched) {
  const std::string page = report_html({sample_material()}, {});
  for (const char* outside : {"http:", "https:", "src=", "@import", "url(", "<link"})
    EXPECT_FALSE(has(page, outside)) << outside;
}

TEST(Report, ShowsTheFigures) {
  const std::string page = report_html({sample_material()}, {});
  for (const char* shown : {"12\u2009345", "43.2", "1.19", "3.1 × 10⁻⁸", "rejected", "18 tests", "3 × 10⁻⁷",
                            "half_vector", "estimated bounds"}) {
    EXPECT_TRUE(has(page, shown)) << shown;
  }
  EXPECT_FALSE(has(page, ">holds<"));
  EXPECT_TRUE(has(page, "<td>–</td>"));  // build seconds were not measured
}

TEST(Report, ClaimsOfChiSquareWhatWasMeasured) {
  ReportMaterial rejected = sample_material(), passed = sample_material(), untested = sample_material();
  passed.figures.chi_square->passed = true;
  untested.figures.chi_square.reset();
  EXPECT_TRUE(has(report_html({passed, passed}, {}), "test holds for all."));
  EXPECT_TRUE(has(report_html({passed, untested}, {}), "test holds for 1."));
  EXPECT_TRUE(has(report_html({passed, rejected}, {}), "test rejects 1."));
  EXPECT_TRUE(has(report_html({rejected}, {}), "test rejects it."));
  EXPECT_FALSE(has(report_html({untested}, {}), "test holds"));
}

TEST(Report, EveryPictureHasWords) {
  const std::string page = report_html({sample_material()}, {});
  std::size_t pictures = 0, words = 0;
  for (std::size_t i = page.find("<svg"); i != page.npos; i = page.find("<svg", i + 1)) ++pictures;
  for (std::size_t i = page.find("role=\"img\" aria-label=\""); i != page.npos;
       i = page.find("role=\"img\" aria-label=\"", i + 1))
    ++words;
  EXPECT_EQ(pictures, 3U);
  EXPECT_EQ(words, pictures);
}

}  // namespace
}  // namespace reflectree::draw
