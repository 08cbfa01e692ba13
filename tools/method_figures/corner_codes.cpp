// SPDX-License-Identifier: Apache-2.0
// The paper's fit of a leaf to the disk: four corner tests make a code, the code says what the box that
// rejection draws from shrinks to. For cells of a quadtree, which never straddle an axis below the root.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "figures.hpp"
#include "reflectree/draw/svg.hpp"

namespace reflectree::method {

using namespace draw;

namespace {

struct Box {
  double x0, x1, y0, y1;
};

// Bit i: corner i lies inside the disk; lower left, lower right, upper right, upper left.
int corner_code(const Box& b) {
  const auto inside = [](double x, double y) { return x * x + y * y <= 1; };
  return 8 * inside(b.x0, b.y0) + 4 * inside(b.x1, b.y0) + 2 * inside(b.x1, b.y1) + inside(b.x0, b.y1);
}

// The smallest box around the part of the cell inside the disk: each side moves in to where the arc is at the
// cell's coordinate nearest to an axis.
Box shrunk(const Box& b) {
  const auto reach = [](double lo, double hi) {
    const double nearest = lo > 0 ? lo : hi < 0 ? -hi : 0;
    return std::sqrt(1 - nearest * nearest);
  };
  const double rx = reach(b.y0, b.y1), ry = reach(b.x0, b.x1);
  return {std::max(b.x0, -rx), std::min(b.x1, rx), std::max(b.y0, -ry), std::min(b.y1, ry)};
}

// A cell of a quadtree with this code; none for the two diagonal codes.
std::optional<Box> find_cell(int code) {
  if (code == 0) return Box{-1, 1, -1, 1};  // the root: no corner inside, but all of the disk
  for (const int n : {4, 8, 16}) {
    for (int k = 0; k < n * n; ++k) {
      const double s = 2.0 / n, x = -1 + s * (k % n), y = -1 + s * double(k / n);
      const Box b{x, x + s, y, y + s};
      if (corner_code(b) == code) return b;
    }
  }
  return std::nullopt;
}

Figure panel(int code) {
  std::string bits;
  for (const int bit : {8, 4, 2, 1}) bits += code & bit ? '1' : '0';
  Figure figure{150, 176, bits, {}, {}};
  const std::optional<Box> cell = find_cell(code);
  figure.body = label(75, 20, bits, Anchor::middle, "head");
  const double left = 30, top = 38, side = 90;
  if (!cell) {
    figure.body += rectangle(left, top, side, side, "box-dashed");
    figure.body += label(75, 87, "cannot occur", Anchor::middle, "note");
    figure.body += label(75, 158, "the disk is convex", Anchor::middle, "note");
    return figure;
  }
  const double scale = side / (cell->x1 - cell->x0);
  const auto px = [&](double x) { return left + (x - cell->x0) * scale; };
  const auto py = [&](double y) { return top + side - (y - cell->y0) * scale; };
  // The part inside the disk, column by column.
  PathData inside, arc;
  bool first = true;
  std::vector<std::array<double, 2>> back;
  for (int i = 0; i <= 60; ++i) {
    const double x = cell->x0 + (cell->x1 - cell->x0) * i / 60, h2 = 1 - x * x;
    if (h2 < 0) continue;
    const double h = std::sqrt(h2), lo = std::max(cell->y0, -h), hi = std::min(cell->y1, h);
    if (lo > hi) continue;
    first ? inside.move_to(px(x), py(hi)) : inside.line_to(px(x), py(hi));
    first = false;
    back.push_back({px(x), py(lo)});
  }
  std::reverse(back.begin(), back.end());
  for (const auto& p : back) inside.line_to(p[0], p[1]);
  if (!inside.empty()) inside.close();
  // The rim where it crosses the cell, with some room around it.
  bool down = false;
  const double margin = 0.1 * (cell->x1 - cell->x0);
  for (int i = 0; i <= 1440; ++i) {
    const double a = i * pi_v<double> / 720, x = std::cos(a), y = std::sin(a);
    const bool near =
        x >= cell->x0 - margin && x <= cell->x1 + margin && y >= cell->y0 - margin && y <= cell->y1 + margin;
    if (near && i % (code == 0 ? 12 : 1) == 0) down ? arc.line_to(px(x), py(y)) : arc.move_to(px(x), py(y));
    if (!near || i % (code == 0 ? 12 : 1) == 0) down = near;
  }
  const Box fit = shrunk(*cell);
  figure.body += path(inside, "fill-1");
  figure.body += rectangle(left, top, side, side, "box");
  figure.body += path(arc, "rim");
  figure.body +=
      rectangle(px(fit.x0), py(fit.y1), (fit.x1 - fit.x0) * scale, (fit.y1 - fit.y0) * scale, "fit");
  const std::array<std::array<double, 2>, 4> corners{
      {{cell->x0, cell->y0}, {cell->x1, cell->y0}, {cell->x1, cell->y1}, {cell->x0, cell->y1}}};
  for (int i = 0; i < 4; ++i) {
    const bool in = code & (8 >> i);
    figure.body += circle(px(corners[std::size_t(i)][0]), py(corners[std::size_t(i)][1]), 4.2,
                          in ? "corner-in" : "corner-out");
  }
  const double kept = (fit.x1 - fit.x0) * (fit.y1 - fit.y0) / ((cell->x1 - cell->x0) * (cell->y1 - cell->y0));
  figure.body += label(75, 158,
                       code == 0      ? "only the root, or empty"
                       : kept > 0.999 ? "nothing to cut"
                                      : number(100 * kept, 0) + " % of the cell",
                       Anchor::middle, "note");
  return figure;
}

}  // namespace

Figure corner_codes_figure() {
  std::vector<Figure> panels;
  for (int code = 0; code < 16; ++code) panels.push_back(panel(code));
  Figure figure =
      side_by_side("Corner codes",
                   "The sixteen codes of a cell's four corners, inside the disk or not, the part of the cell "
                   "inside the disk, and the box that rejection draws from.",
                   panels, 8, 0);
  const double y = figure.height + 18;
  figure.body +=
      circle(40, y - 4, 4.2, "corner-in") + label(52, y, "corner inside the disk", Anchor::start, "note") +
      circle(202, y - 4, 4.2, "corner-out") + label(214, y, "outside", Anchor::start, "note") +
      rectangle(288, y - 10, 16, 11, "fill-1") + label(310, y, "part inside", Anchor::start, "note") +
      rectangle(392, y - 10, 16, 11, "fit") +
      label(414, y, "box that rejection draws from", Anchor::start, "note") +
      label(figure.width - 30, y, "order of the bits: lower left, lower right, upper right, upper left",
            Anchor::end, "note");
  figure.height += 34;
  return figure;
}

}  // namespace reflectree::method
