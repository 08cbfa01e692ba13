// SPDX-License-Identifier: Apache-2.0
// Borders of cells are where the map puts them: rings and spokes on the disk.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "reflectree/draw/material_figures.hpp"
#include "reflectree/draw/square_image.hpp"
#include "xml_check.hpp"

namespace reflectree::draw {
namespace {

struct Point {
  double x, y;
};

// The points of every path in a drawing: moves and lines, the first absolute, others relative.
std::vector<Point> points_of(const std::string& svg) {
  std::vector<Point> points;
  for (std::size_t at = svg.find(" d=\""); at != svg.npos; at = svg.find(" d=\"", at + 1)) {
    Point p{0, 0};
    const char* c = svg.c_str() + at + 4;
    while (*c != '"') {
      if (*c == 'M' || *c == 'm' || *c == 'l' || *c == ' ') {
        ++c;
        continue;
      }
      char* end = nullptr;
      p.x += std::strtod(c, &end);
      p.y += std::strtod(end, &end);
      points.push_back(p);
      c = end;
    }
  }
  return points;
}

std::string borders(const std::vector<TreeSplit>& nodes, const Domain& domain, Direction wo) {
  const DiskImage dark{2, {0, 0, 0, 0}};
  return cell_borders(nodes, domain, wo, 200, 200, 100, dark, {0.1, 1, 0, 1, true});
}

// The largest distance of a border from the circle of this radius about the centre.
double off_the_ring(const std::string& svg, double radius) {
  double worst = 0;
  for (const Point& p : points_of(svg)) {
    worst = std::max(worst, std::abs(std::hypot(p.x - 200, p.y - 200) - radius));
  }
  return worst;
}

constexpr Domain disk_half{DomainKind::projected_disk, Symmetry::mirror, 0},
    disk_full{DomainKind::projected_disk, Symmetry::none, 0};
const std::vector<TreeSplit> one_leaf{TreeSplit::leaf},
    along_y{TreeSplit::y, TreeSplit::leaf, TreeSplit::leaf},
    along_x{TreeSplit::x, TreeSplit::leaf, TreeSplit::leaf};

TEST(CellBorders, OneLeafHasNone) {
  EXPECT_EQ(borders(one_leaf, disk_half, viewer_at(0.5f)), "");
  EXPECT_EQ(borders(one_leaf, disk_full, viewer_at(0.5f)), "");
}

TEST(CellBorders, ARadiusIsARing) {
  const std::string ring = borders(along_y, disk_half, viewer_at(0.5f));
  EXPECT_GT(points_of(ring).size(), 20U);
  EXPECT_LT(off_the_ring(ring, 100 * std::sqrt(0.5)), 0.2);  // y = sin^2 theta_i = 1/2
  EXPECT_GT(off_the_ring(borders(along_x, disk_half, viewer_at(0.5f)), 100 * std::sqrt(0.5)), 20);
}

TEST(CellBorders, AnAzimuthIsASpokeFromThePole) {
  for (const Point& p : points_of(borders(along_x, disk_half, viewer_at(0.5f)))) EXPECT_NEAR(p.x, 200, 0.11);
  // Of half vectors: from the mirror direction, across the plane of incidence, to the rim.
  const Direction wo = viewer_at(0.9f);
  const std::vector<Point> spoke =
      points_of(borders(along_x, {DomainKind::half_vector, Symmetry::mirror, 0}, wo));
  ASSERT_FALSE(spoke.empty());
  EXPECT_NEAR(spoke.front().x, 200 - 100 * double(wo.x), 0.2);
  EXPECT_NEAR(spoke.front().y, 200, 0.2);
  EXPECT_NEAR(std::hypot(spoke.back().x - 200, spoke.back().y - 200), 100, 0.2);
}

TEST(CellBorders, AnAzimuthOfAFullSquareIsADiameterAndAHalfIsMirrored) {
  const std::string whole = borders(along_x, disk_full, viewer_at(0.f)),
                    half = borders(along_x, disk_half, viewer_at(0.f));
  ASSERT_FALSE(points_of(whole).empty());
  EXPECT_NEAR(points_of(whole).front().y, 300, 0.11);
  EXPECT_NEAR(points_of(whole).back().y, 100, 0.11);
  EXPECT_EQ(whole.find("<use"), whole.npos);
  EXPECT_NE(half.find("<use"), half.npos);
}

TEST(CellBorders, SidesOfAFullSquareMeetInThePlaneOfIncidence) {
  const std::vector<Point> seam = points_of(borders(along_y, disk_full, viewer_at(0.5f)));
  double left = 200, right = 200;
  for (const Point& p : seam) {
    EXPECT_NEAR(p.y, 200, 0.11);
    left = std::min(left, p.x), right = std::max(right, p.x);
  }
  EXPECT_NEAR(left, 100, 0.11);
  EXPECT_NEAR(right, 300, 0.11);
}

TEST(SquareImage, ThePoleIsBelowAndTheViewersSideOnTheRight) {
  const SquarePlace half{10, 20, 200, true}, full{10, 20, 200, false};
  EXPECT_EQ(half.px(1), 210);
  EXPECT_EQ(half.py(0), 120);
  EXPECT_EQ(half.py(1), 20);
  EXPECT_EQ(full.py(0), 120);
  EXPECT_EQ(full.py(-1), 220);
  EXPECT_EQ(cell_rectangle({-1, 0, 0, 0.25f}, half, "box"), rectangle(10, 95, 100, 25, "box"));
}

TEST(SquareImage, AsksForEveryPixelOnce) {
  int calls = 0;
  bool inside = true;
  const auto g = [&](Vec2<float> p) {
    ++calls;
    inside = inside && std::abs(p.x) < 1 && p.y > 0 && p.y < 1;
    return 1.0;
  };
  const std::string image = square_raster(g, {0.1, 10, 0, 1, true}, {0, 0, 100, true}, 16);
  EXPECT_EQ(calls, 128);
  EXPECT_TRUE(inside);
  EXPECT_EQ(xml_fault("<svg>" + image + square_axes({0, 0, 100, true}) + "</svg>"), "");
}

}  // namespace
}  // namespace reflectree::draw
