// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/plot.hpp"

#include <gtest/gtest.h>

#include "reflectree/draw/figure.hpp"
#include "xml_check.hpp"

namespace reflectree::draw {
namespace {

std::vector<std::string> texts(const std::vector<Tick>& all) {
  std::vector<std::string> out;
  for (const Tick& t : all) out.push_back(t.text);
  return out;
}

TEST(Axis, MapsAndClamps) {
  const Axis linear{0, 10, 100, 200}, log{0.01, 100, 0, 40, true};
  EXPECT_DOUBLE_EQ(linear.at(2.5), 125);
  EXPECT_DOUBLE_EQ(linear.at(-1), 100);
  EXPECT_NEAR(log.at(1), 20, 1e-12);
  EXPECT_DOUBLE_EQ(log.at(0), 0);
  EXPECT_DOUBLE_EQ(log.at(1e9), 40);
}

TEST(Ticks, RoundValues) {
  EXPECT_EQ(texts(ticks({0, 1, 0, 1})), (std::vector<std::string>{"0", "0.2", "0.4", "0.6", "0.8", "1"}));
  EXPECT_EQ(texts(ticks({0, 37, 0, 1}, 4)), (std::vector<std::string>{"0", "10", "20", "30"}));
  EXPECT_EQ(texts(ticks({0.5, 700, 0, 1, true})), (std::vector<std::string>{"1", "10", "100"}));
  EXPECT_EQ(texts(ticks({0.15, 0.6, 0, 1, true})), (std::vector<std::string>{"0.2", "0.5"}));
  EXPECT_EQ(texts(ticks({0.8, 1.25, 0, 1, true}, 4)),
            (std::vector<std::string>{"0.8", "0.9", "1", "1.1", "1.2"}));
  EXPECT_EQ(texts(ticks({-1, 1, 0, 1}, 4)), (std::vector<std::string>{"−1", "−0.5", "0", "0.5", "1"}));
  EXPECT_EQ(texts(ticks_every({-90, 90, 0, 1}, 45, "°")),
            (std::vector<std::string>{"−90°", "−45°", "0°", "45°", "90°"}));
}

TEST(Curve, BreaksWhereThereIsNoValue) {
  Frame f;
  f.x = {0, 3, 0, 30};
  f.y = {0, 1, 10, 0};
  const std::vector<double> x{0, 1, 2, 3}, whole{0, 0, 1, 1}, broken{0, std::nan(""), 1, 1};
  EXPECT_NE(curve(f, x, whole, "curve").find("M0 10l10 0 10-10 10 0"), std::string::npos);
  EXPECT_NE(curve(f, x, broken, "curve").find("M0 10m20-10l10 0"), std::string::npos);
}

TEST(Figure, FilesAndPagesAreWellFormed) {
  Frame f;
  f.x = {0, 1, 40, 200};
  f.y = {1, 1000, 150, 20, true};
  f.x_ticks = ticks(f.x);
  f.y_ticks = ticks(f.y);
  f.x_title = "*x* & <y>_i";
  const Figure one{240, 200, "a < b", "\"quoted\" & more",
                   frame(f) + colour_bar({{0.1, 10, 10, 90, true}, 160, 8, "c"})};
  const Figure two = side_by_side("t", "d", {one, one, one}, 2);
  for (const Figure& figure : {one, two}) {
    EXPECT_EQ(xml_fault(to_svg(figure)), "");
    EXPECT_EQ(xml_fault(inline_svg(figure)), "");
  }
  EXPECT_EQ(two.width, 500);
  EXPECT_EQ(two.height, 420);
}

}  // namespace
}  // namespace reflectree::draw
