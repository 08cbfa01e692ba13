// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>

#include "disk_frame.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/sampler/square/domain_map.hpp"

namespace reflectree::draw {

namespace {

// A border of the square as a curve over the disk: halved until a chord stays within a tenth of a unit,
// split by the brightness behind it.
class BorderPen {
 public:
  BorderPen(const Domain& domain, Direction wo, const DiskPlace& place, const DiskImage& background,
            const Axis& range)
      : domain_(domain), wo_(wo), place_(place), background_(background), range_(range) {
    range_.from = 0;
    range_.to = 1;
  }

  // Not drawn: borders between halves (with p and q in their middles) that are less than a unit apart.
  bool worth_drawing(Vec2<float> p, Vec2<float> q) const {
    const Point a = lifted(p), b = lifted(q);
    return std::hypot(b.x - a.x, b.y - a.y) * place_.radius >= 1;
  }

  void draw(Vec2<float> a, Vec2<float> b) {
    constexpr int pieces = 4;  // at least: a ring's first chord would be a diameter
    Point from = lifted(a);
    for (int k = 1; k <= pieces; ++k) {
      const float t = float(k) / pieces;
      const Vec2<float> p{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
      const Point to = lifted(p);
      refine(from, to, 0);
      from = to;
    }
  }
  // A half domain's other side is drawn as a mirror image.
  std::string text() const { return both_sides(dark_, "cells-dark") + both_sides(light_, "cells-light"); }

 private:
  struct Point {
    Vec2<float> square;
    double x = 0, y = 0;
  };

  std::string both_sides(const PathData& data, std::string_view css_class) const {
    if (data.empty()) return "";
    std::string borders;
    if (domain_.half()) {
      // Named by its content (FNV-1a), so that figures may share a page.
      std::uint64_t hash = 0xcbf29ce484222325ULL;
      for (const char c : data.text()) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
      const std::string id = "c" + std::to_string(hash);
      const std::string mirror = "matrix(1 0 0 -1 0 " + number(2 * place_.y) + ")";
      borders = element("path", {{"id", id}, {"d", data.text()}}) +
                element("use", {{"href", "#" + id}, {"transform", mirror}});
    } else {
      borders = element("path", {{"d", data.text()}});
    }
    return element("g", {{"class", css_class}}, borders) + "\n";
  }

  Point lifted(Vec2<float> p) const {
    const Direction wi = lift(domain_, wo_, p).geometry.wi;
    return {p, wi.x, wi.y};
  }

  double brightness_at(double x, double y) const {
    const float v = background_.at(x, y);
    return range_.at(std::isnan(v) ? 0.0 : double(v));
  }

  void refine(const Point& a, const Point& b, int depth) {
    const Point m = lifted({0.5f * (a.square.x + b.square.x), 0.5f * (a.square.y + b.square.y)});
    const double bend = std::hypot(m.x - 0.5 * (a.x + b.x), m.y - 0.5 * (a.y + b.y)) * place_.radius;
    const double length = std::hypot(b.x - a.x, b.y - a.y) * place_.radius;
    if (depth < 8 && (bend > 0.1 || length > 12)) {
      refine(a, m, depth + 1);
      refine(m, b, depth + 1);
      return;
    }
    // The mean of both sides: the pixel under the border itself may belong to either.
    const double aside = length > 0 ? 3 / length : 0;
    const double nx = (a.y - b.y) * aside, ny = (b.x - a.x) * aside;
    const double brightness = 0.5 * (brightness_at(m.x + nx, m.y + ny) + brightness_at(m.x - nx, m.y - ny));
    // With some inertia, so that a border across an even middle tone is not broken into dashes.
    const bool joined = last_x_ == a.x && last_y_ == a.y;
    const bool bright = brightness > (!joined || latest_ == nullptr ? 0.62 : latest_ == &dark_ ? 0.52 : 0.72);
    PathData& data = bright ? dark_ : light_;
    if (latest_ != &data || !joined) data.move_to(place_.px(a.x), place_.py(a.y));
    data.line_to(place_.px(b.x), place_.py(b.y));
    latest_ = &data;
    last_x_ = b.x;
    last_y_ = b.y;
  }

  Domain domain_;
  Direction wo_;
  DiskPlace place_;
  const DiskImage& background_;
  Axis range_;
  PathData dark_, light_;
  PathData* latest_ = nullptr;
  double last_x_ = 0, last_y_ = 0;
};

}  // namespace

std::string cell_borders(const std::vector<TreeSplit>& nodes, const Domain& domain, Direction wo, double x,
                         double y, double radius, const DiskImage& background, const Axis& range) {
  BorderPen pen(domain, wo, {x, y, radius}, background, range);
  // Each inner node draws the line that halves its box: every border once. The edges of the square are no
  // borders where a leaf continues beyond them: y = 0 of a half square is the pole, and across x = -1 and 1,
  // the plane of incidence, lies the leaf's own mirror image. In a full square it is another leaf's.
  for_each_node(nodes, domain.symmetry, [&](TreeSplit split, const SquareCell& c) {
    if (split == TreeSplit::leaf) {
      if (domain.half() || c.y0 < 0) return;
      for (const float edge : {-1.f, 1.f}) {
        if (c.x0 == edge || c.x1 == edge) pen.draw({edge, c.y0}, {edge, c.y1});
      }
      return;
    }
    const bool along_x = split == TreeSplit::x;
    const Vec2<float> centre{0.5f * (c.x0 + c.x1), 0.5f * (c.y0 + c.y1)};
    const Vec2<float> step =
        along_x ? Vec2<float>{0.25f * (c.x1 - c.x0), 0} : Vec2<float>{0, 0.25f * (c.y1 - c.y0)};
    // A wedge that holds the pole is widest at its rim.
    const Vec2<float> at{centre.x, !along_x ? centre.y : -c.y0 > c.y1 ? c.y0 : c.y1};
    if (!pen.worth_drawing({at.x - step.x, at.y - step.y}, {at.x + step.x, at.y + step.y})) return;
    along_x ? pen.draw({centre.x, c.y0}, {centre.x, c.y1}) : pen.draw({c.x0, centre.y}, {c.x1, centre.y});
  });
  return pen.text();
}

}  // namespace reflectree::draw
