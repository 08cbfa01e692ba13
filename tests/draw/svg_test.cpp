// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/svg.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <locale>

#include "xml_check.hpp"

namespace reflectree::draw {
namespace {

TEST(Escape, MarkupBecomesText) {
  EXPECT_EQ(escape("a<b>&\"c\"'"), "a&lt;b&gt;&amp;&quot;c&quot;&#39;");
  EXPECT_EQ(escape("θₒ 1/π µm"), "θₒ 1/π µm");
}

TEST(Escape, BytesThatXmlForbidsAreReplaced) {
  const std::string replacement = "\xef\xbf\xbd";
  EXPECT_EQ(escape(std::string_view("a\0b\x1b", 4)), "a" + replacement + "b" + replacement);
  EXPECT_EQ(escape("\xff"), replacement);
  EXPECT_EQ(escape("\xc3"), replacement);                                      // cut short
  EXPECT_EQ(escape("\xc0\xaf"), replacement + replacement);                    // overlong
  EXPECT_EQ(escape("\xed\xa0\x80"), replacement + replacement + replacement);  // surrogate
}

TEST(Number, FixedWithoutTrailingZeros) {
  EXPECT_EQ(number(1.5), "1.5");
  EXPECT_EQ(number(2.0), "2");
  EXPECT_EQ(number(1000), "1000");
  EXPECT_EQ(number(-0.001), "0");
  EXPECT_EQ(number(0.126), "0.13");
  EXPECT_EQ(number(1.23456, 4), "1.2346");
}

TEST(Number, IgnoresTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const std::string small = number(0.5), large = number(12345.5), for_people = pretty(0.025);
  std::locale::global(before);
  EXPECT_EQ(small, "0.5");
  EXPECT_EQ(large, "12345.5");
  EXPECT_EQ(for_people, "0.025");
}

TEST(Pretty, SignificantDigits) {
  EXPECT_EQ(pretty(1.1873), "1.19");
  EXPECT_EQ(pretty(9.996), "10");
  EXPECT_EQ(pretty(0.0083, 2), "0.0083");
  EXPECT_EQ(pretty(3.14e-8), "3.14 × 10⁻⁸");
  EXPECT_EQ(pretty(1e-12), "10⁻¹²");
  EXPECT_EQ(pretty(12345, 9), "12\u2009345");
  EXPECT_EQ(pretty(1234, 9), "1234");
  EXPECT_EQ(pretty(-2.5), "−2.5");
  EXPECT_EQ(pretty(std::numeric_limits<double>::quiet_NaN()), "–");
}

TEST(Rich, ItalicsAndSubscripts) {
  const std::string theta = rich("*θ*_o = 45°");
  EXPECT_NE(theta.find("<tspan class=\"math\">θ</tspan>"), std::string::npos);
  EXPECT_NE(theta.find(">o</tspan>"), std::string::npos);
  for (const char* text : {"*θ*_o", "*open", "a_{max", "_", "<*&*>", "a_"}) {
    EXPECT_EQ(xml_fault("<t>" + rich(text) + "</t>"), "") << text;
  }
}

TEST(PathData, RelativeTenthsNeverDrift) {
  PathData data;
  data.move_to(1, 2);
  for (int i = 1; i <= 100; ++i) data.line_to(1 + i * 0.333, 2);
  // The steps, read back, add up to the last point rounded once: 34.3.
  const std::string text = data.text();
  ASSERT_EQ(text.substr(0, 5), "M1 2l");
  long tenths = 10;
  for (std::size_t i = 5; i < text.size();) {
    std::size_t used = 0;
    tenths += std::lround(std::stod(text.substr(i), &used) * 10);
    i += used;
    const double dy = std::stod(text.substr(i), &used);
    EXPECT_EQ(dy, 0);
    i += used;
  }
  EXPECT_EQ(tenths, 343);
}

TEST(PathData, SeparatesNumbersWithTheFewestBytes) {
  PathData data;
  data.move_to(0.5, -0.5);
  data.line_to(-1, 3);
  data.dot(10, 10);
  EXPECT_EQ(data.text(), "M.5-.5l-1.5 3.5m11 7h0");
}

TEST(XmlCheck, SeesFaults) {
  EXPECT_EQ(xml_fault("<a b=\"c\"><d/>x &amp; y</a>"), "");
  for (const char* bad : {"<a><b></a></b>", "<a b=c/>", "<a>&nbsp;</a>", "<a>x & y</a>", "<a", "<a/><b/>",
                          "x<a/>", "<a b=\"1\" b=\"2\"/>", "<a b=\"<\"/>", "<a>", ""}) {
    EXPECT_NE(xml_fault(bad), "") << bad;
  }
}

}  // namespace
}  // namespace reflectree::draw
